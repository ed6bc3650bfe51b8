#pragma once

#include "bake/vk/device.h"
#include "bake/vk/memory_ledger.h"

namespace relume::vk {

/// Owns device memory and its place in the device's ledger; move-only. allocateMemory() makes one.
class MemoryBlock {
public:
    MemoryBlock() = default;
    /// Takes over memory of so many bytes and adds them to the account.
    MemoryBlock(const Device& device, VkDeviceMemory memory, VkDeviceSize size,
                MemoryLedger::Account& account);
    ~MemoryBlock();
    MemoryBlock(MemoryBlock&& other) noexcept;
    MemoryBlock& operator=(MemoryBlock&& other) noexcept;

    VkDeviceMemory handle() const { return memory_; }
    VkDeviceSize size() const { return size_; }
    void release(); // unmaps, too

private:
    const Device* device_ = nullptr;
    VkDeviceMemory memory_ = VK_NULL_HANDLE;
    VkDeviceSize size_ = 0;
    MemoryLedger::Account* account_ = nullptr;
};

} // namespace relume::vk
