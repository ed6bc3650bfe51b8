#pragma once

#include <string>

#include "bake/vk/memory_block.h"

namespace relume::vk {

struct MemoryDesc {
    VkDeviceSize size = 0;       // [bytes]
    uint32_t type = ~0u;         // ~0u: there is none
    bool ofHost = false;         // Memory::Host, which is none of the device's
    const void* chain = nullptr; // what follows VkMemoryAllocateInfo
    const char* name = "";       // for the device's ledger
    std::string what;            // for an Error: "buffer 'bits' of 3 MiB"
};
/// Allocates memory and counts it. Throws Error naming what it is for, and the free memory.
MemoryBlock allocateMemory(const Device& device, const MemoryDesc& desc);
/// Checks as check() does, but names `what` where it is out of memory.
void checkMemory(const Device& device, VkResult result, const char* call, const std::string& what);

/// Returns "3 MiB" and the like, rounded up.
std::string inMiB(uint64_t bytes);

} // namespace relume::vk
