#pragma once

#include <cstdint>
#include <optional>

#include "bake/baker/memory_needs.h"
#include "bake/vk/device.h"

namespace relume {

/// Tells what a device and its host have to give to a bake.
struct BakeRoom {
    uint64_t device = 0;          // free memory of the device [bytes]
    std::optional<uint64_t> host; // and of the host, where it tells
    uint32_t imageEdge = 0;       // the largest image that the device takes [texels]
    bool software = false;        // its memory is the host's, and what it needs counts the host's copies
};
/// Returns the room of a device and of this machine as they are now.
BakeRoom roomOn(const vk::Device& device);

/// Edges of pages that a viewer chooses are multiples of this [texels], or powers of two below it.
constexpr uint32_t kSizeStride = 512;

/// Returns the edge of a lightmap's page, the largest of `most` and the multiples of kSizeStride and powers
/// of two below it, with which a bake takes no more than half of the room; none below `least` is tried, which
/// is the answer where none fits. The other half is for what grows as long as there is memory: links, layers,
/// the picture.
uint32_t fittingSize(const BakeSettings& settings, const SceneExtent& scene, const BakeRoom& room,
                     uint32_t least, uint32_t most);

} // namespace relume
