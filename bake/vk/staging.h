#pragma once

#include <mutex>

#include "bake/vk/buffer.h"
#include "bake/vk/commands.h"

namespace relume::vk {

/// Copies between host memory and a device's buffers. Where the CPU cannot see a buffer, copies go
/// through a window that stays: a driver takes longer to make one than to copy. Any thread may use it.
class Staging {
public:
    explicit Staging(const Device& device) : device_(device), commands_(device) {}

    void upload(const Buffer& buffer, const void* data, VkDeviceSize size, VkDeviceSize offset);
    void uploadParts(const Buffer& buffer, const void* data, std::span<const BufferPart> parts);
    void download(const Buffer& buffer, void* data, VkDeviceSize size, VkDeviceSize offset);

private:
    const Buffer& windowFor(VkDeviceSize size);

    const Device& device_;
    std::mutex mutex_;
    Buffer small_, large_; // windows, made when they are first needed
    Commands commands_;
};

} // namespace relume::vk
