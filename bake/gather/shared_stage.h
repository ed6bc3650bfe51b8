#pragma once

#include <optional>

#include "bake/ranks/ranks.h"
#include "bake/vk/buffer.h"

namespace relume {

/// Memory that the ranks of one machine and their devices see. Ranks write their parts, meet, and read those
/// of others. It has two halves that are used in turn: by the time that one is written again, all have met
/// once more and so have read what stood there.
class SharedStage {
public:
    SharedStage(const vk::Device& device, Ranks& ranks) : device_(device), ranks_(ranks) {}

    /// Makes room for so many bytes ahead, which takes longer than to fill it. All ranks call it alike.
    void reserve(VkDeviceSize bytes) {
        if (!none_ && bytes > half_) none_ = !grow(bytes);
    }
    /// Turns to the other half, with room for so many bytes, and returns where it begins in buffer(). Returns
    /// nothing where ranks are on several machines or one cannot have such memory. All ranks call it alike.
    std::optional<VkDeviceSize> turn(VkDeviceSize bytes);
    const vk::Buffer& buffer() const { return buffer_; }

private:
    bool grow(VkDeviceSize bytes);

    const vk::Device& device_;
    Ranks& ranks_;
    SharedBlock block_;
    vk::Buffer buffer_; // is the block; goes before it
    VkDeviceSize half_ = 0;
    bool second_ = false, none_ = false;
};

} // namespace relume
