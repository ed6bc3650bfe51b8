#include "bake/vk/staging.h"

#include <algorithm>
#include <cstring>

#include "assets/base/worker_pool.h"

namespace relume::vk {
namespace {

// Small copies go through a window of this size [bytes].
constexpr VkDeviceSize kSmallBytes = VkDeviceSize{4} << 20;
// Large ones go through one of this size [bytes]: big enough for PCIe's full speed, small enough to be always
// available.
constexpr VkDeviceSize kLargeBytes = VkDeviceSize{32} << 20;

// A thread copies so much at a time [bytes]; one core alone does not fill PCIe.
constexpr VkDeviceSize kCopiedAtATime = VkDeviceSize{2} << 20;

void copyByAll(const Device& device, void* to, const void* from, VkDeviceSize size) {
    const auto portions = static_cast<uint32_t>((size + kCopiedAtATime - 1) / kCopiedAtATime);
    device.workers().run(portions, [&](uint32_t portion) {
        const VkDeviceSize begin = portion * kCopiedAtATime, count = std::min(kCopiedAtATime, size - begin);
        std::memcpy(static_cast<char*>(to) + begin, static_cast<const char*>(from) + begin, count);
    });
}

void copy(VkCommandBuffer cmd, const Buffer& from, VkDeviceSize fromOffset, const Buffer& to,
          VkDeviceSize toOffset, VkDeviceSize size) {
    const VkBufferCopy region{fromOffset, toOffset, size};
    vkCmdCopyBuffer(cmd, from.handle(), to.handle(), 1, &region);
}

} // namespace

// Sums over the chunks of a large lightmap are read many times in a bake, so the large window stays as well.
const Buffer& Staging::windowFor(VkDeviceSize size) {
    const MemoryOwner owner("staging");
    Buffer& window = size <= kSmallBytes ? small_ : large_;
    if (!window)
        window = Buffer(device_, {.size = size <= kSmallBytes ? kSmallBytes : kLargeBytes,
                                  .memory = Memory::Host,
                                  .name = size <= kSmallBytes ? "staging" : "large staging"});
    return window;
}

void Staging::upload(const Buffer& buffer, const void* data, VkDeviceSize size, VkDeviceSize offset) {
    const std::lock_guard lock(mutex_);
    if (buffer.mapped() != nullptr) {
        barrier(commands_.begin()); // earlier work may still use the buffer
        commands_.run();
        copyByAll(device_, static_cast<char*>(buffer.mapped()) + offset, data, size);
        return;
    }
    const Buffer& window = windowFor(size);
    for (VkDeviceSize done = 0; done < size; done += window.size()) {
        const VkDeviceSize piece = std::min(window.size(), size - done);
        copyByAll(device_, window.mapped(), static_cast<const char*>(data) + done, piece);
        VkCommandBuffer cmd = commands_.begin();
        barrier(cmd);
        copy(cmd, window, 0, buffer, offset + done, piece);
        barrier(cmd);
        commands_.run();
    }
}

// Copies through the small window, however much it is: few parts fill it.
void Staging::uploadParts(const Buffer& buffer, const void* data, std::span<const BufferPart> parts) {
    if (parts.empty()) return;
    const std::lock_guard lock(mutex_);
    const auto* from = static_cast<const char*>(data);
    if (buffer.mapped() != nullptr) {
        barrier(commands_.begin()); // earlier work may still use the buffer
        commands_.run();
        for (const BufferPart& part : parts)
            std::memcpy(static_cast<char*>(buffer.mapped()) + part.offset, from + part.offset, part.size);
        return;
    }
    const Buffer& window = windowFor(kSmallBytes);
    std::vector<VkBufferCopy> regions;
    VkDeviceSize used = 0;
    const auto flush = [&] {
        VkCommandBuffer cmd = commands_.begin();
        barrier(cmd);
        vkCmdCopyBuffer(cmd, window.handle(), buffer.handle(), static_cast<uint32_t>(regions.size()),
                        regions.data());
        barrier(cmd);
        commands_.run();
        regions.clear();
        used = 0;
    };
    for (const BufferPart& part : parts) {
        for (VkDeviceSize done = 0; done < part.size;) {
            if (used == window.size()) flush();
            const VkDeviceSize piece = std::min(window.size() - used, part.size - done);
            std::memcpy(static_cast<char*>(window.mapped()) + used, from + part.offset + done, piece);
            regions.push_back({used, part.offset + done, piece});
            used += piece;
            done += piece;
        }
    }
    flush();
}

void Staging::download(const Buffer& buffer, void* data, VkDeviceSize size, VkDeviceSize offset) {
    const std::lock_guard lock(mutex_);
    if (buffer.mapped() != nullptr) {
        hostBarrier(commands_.begin());
        commands_.run();
        std::memcpy(data, static_cast<const char*>(buffer.mapped()) + offset, size);
        return;
    }
    const Buffer& window = windowFor(size);
    for (VkDeviceSize done = 0; done < size; done += window.size()) {
        const VkDeviceSize piece = std::min(window.size(), size - done);
        VkCommandBuffer cmd = commands_.begin();
        barrier(cmd);
        copy(cmd, buffer, offset + done, window, 0, piece);
        hostBarrier(cmd);
        commands_.run();
        copyByAll(device_, static_cast<char*>(data) + done, window.mapped(), piece);
    }
}

} // namespace relume::vk
