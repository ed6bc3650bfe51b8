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

VkDeviceMemory allocateMemory(const Device& device, VkDeviceSize size, uint32_t type, const void* chain,
                              const std::string& what) {
    if (type == ~0u)
        throw Error(device.info().name + ": no memory type for " + what + ": try another --device");
    if (size > device.heapSize(type)) // asking all the same is against Vulkan's rules
        checkMemory(device, VK_ERROR_OUT_OF_DEVICE_MEMORY, "", what);
    VkMemoryAllocateInfo info{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, chain};
    info.allocationSize = size;
    info.memoryTypeIndex = type;
    VkDeviceMemory memory = VK_NULL_HANDLE;
    checkMemory(device, vkAllocateMemory(device.handle(), &info, nullptr, &memory), "vkAllocateMemory", what);
    return memory;
}

} // namespace relume::vk
