#pragma once

#include <cstdint>

#include "bake/baker/memory_plan.h"

namespace relume {

/// Edges of pages that a viewer chooses are multiples of this [texels], or powers of two below it.
constexpr uint32_t kSizeStride = 512;

/// Returns the edge of a lightmap's page, the largest of `most` and the multiples of kSizeStride and powers
/// of two below it, with which a bake takes no more than half of the room; none below `least` is tried, which
/// is the answer where none fits. The other half is for what grows as long as there is memory: links, layers,
/// the picture.
uint32_t fittingSize(const BakeSettings& settings, const SceneExtent& scene, const BakeRoom& room,
                     uint32_t least, uint32_t most);

} // namespace relume
