#pragma once

#include <cstdint>
#include <vector>

namespace relume {

struct PackedRect {
    uint32_t width = 0, height = 0; // [texels], given
    uint32_t x = 0, y = 0;          // [texels], found
};

/// Places the rectangles in width x height texels with `gutter` empty texels between any two. Returns false
/// where they do not fit; then the places are meaningless.
[[nodiscard]] bool packRects(std::vector<PackedRect>& rects, uint32_t width, uint32_t height,
                             uint32_t gutter);

} // namespace relume
