#pragma once

#include <string>

#include "bake/vk/device.h"

namespace relume::vk {

/// Allocates memory of `type` (~0u: there is none); `chain` is what follows VkMemoryAllocateInfo. Throws
/// Error naming `what` ("buffer 'bits' of 3 MiB") and the free memory.
VkDeviceMemory allocateMemory(const Device& device, VkDeviceSize size, uint32_t type, const void* chain,
                              const std::string& what);
/// Checks as check() does, but names `what` where it is out of memory.
void checkMemory(const Device& device, VkResult result, const char* call, const std::string& what);

/// Returns "3 MiB" and the like, rounded up.
std::string inMiB(uint64_t bytes);

} // namespace relume::vk
