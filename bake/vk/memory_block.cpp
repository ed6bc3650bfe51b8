#include "bake/vk/memory_block.h"

#include <utility>

namespace relume::vk {

MemoryBlock::MemoryBlock(const Device& device, VkDeviceMemory memory, VkDeviceSize size,
                         MemoryLedger::Account& account)
    : device_(&device), memory_(memory), size_(size), account_(&account) {
    device.ledger().add(account, size);
}

MemoryBlock::~MemoryBlock() {
    release();
}

MemoryBlock::MemoryBlock(MemoryBlock&& other) noexcept {
    *this = std::move(other);
}

MemoryBlock& MemoryBlock::operator=(MemoryBlock&& other) noexcept {
    if (this == &other) return *this;
    release();
    device_ = std::exchange(other.device_, nullptr);
    memory_ = std::exchange(other.memory_, VK_NULL_HANDLE);
    size_ = std::exchange(other.size_, 0);
    account_ = std::exchange(other.account_, nullptr);
    return *this;
}

void MemoryBlock::release() {
    if (memory_ == VK_NULL_HANDLE) return;
    vkFreeMemory(device_->handle(), memory_, nullptr);
    device_->ledger().remove(*account_, size_);
    memory_ = VK_NULL_HANDLE;
}

} // namespace relume::vk
