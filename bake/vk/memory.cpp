#include "bake/vk/memory.h"

namespace relume::vk {

std::string inMiB(uint64_t bytes) {
    constexpr uint64_t mask = (1 << 20) - 1;
    return std::to_string((bytes >> 20) + ((bytes & mask) != 0 ? 1 : 0)) + " MiB";
}

void checkMemory(const Device& device, VkResult result, const char* call, const std::string& what) {
    if (result == VK_ERROR_OUT_OF_DEVICE_MEMORY || result == VK_ERROR_OUT_OF_HOST_MEMORY)
        throw Error(device.info().name + ": out of memory for " + what + ", " + inMiB(device.freeMemory()) +
                    " are free: use a smaller --size or close other programs");
    check(result, call);
}

MemoryBlock allocateMemory(const Device& device, const MemoryDesc& desc) {
    if (desc.type == ~0u)
        throw Error(device.info().name + ": no memory type for " + desc.what + ": try another --device");
    // Asking for more than the heap has is against Vulkan's rules.
    const bool beyond = !desc.ofHost && desc.size > device.freeOfLimit();
    if (beyond || desc.size > device.heapSize(desc.type) || !device.ledger().admit())
        checkMemory(device, VK_ERROR_OUT_OF_DEVICE_MEMORY, "", desc.what);
    MemoryLedger::Account& account = device.ledger().open(desc.name, desc.ofHost);
    VkMemoryAllocateInfo info{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, desc.chain};
    info.allocationSize = desc.size;
    info.memoryTypeIndex = desc.type;
    VkDeviceMemory memory = VK_NULL_HANDLE;
    checkMemory(device, vkAllocateMemory(device.handle(), &info, nullptr, &memory), "vkAllocateMemory",
                desc.what);
    return {device, memory, desc.size, account};
}

} // namespace relume::vk
