#pragma once

#include <mutex>

#include "bake/vk/buffer.h"
#include "bake/vk/commands.h"

namespace relume::vk {

/// A device's way between memory of the CPU and buffers that it cannot see. Small copies go through a window
/// that stays: to make one takes a driver longer than to copy. For any thread.
class Staging {
public:
    explicit Staging(const Device& device) : device_(device), commands_(device) {}

    void upload(const Buffer& buffer, const void* data, VkDeviceSize size, VkDeviceSize offset);
    void uploadParts(const Buffer& buffer, const void* data, std::span<const BufferPart> parts);
    void download(const Buffer& buffer, void* data, VkDeviceSize size, VkDeviceSize offset);

private:
    const Buffer& windowFor(VkDeviceSize size, Buffer& large);

    const Device& device_;
    std::mutex mutex_;
    Buffer window_;
    Commands commands_;
};

} // namespace relume::vk
