#pragma once

#include <cstdint>
#include <vector>

#include "assets/model/scene.h"

namespace relume {

/// Holds the charts of one UV set of a mesh.
struct UvCharts {
    std::vector<std::vector<uint32_t>> chart; // [primitive][triangle]; empty for primitives without the set
    uint32_t count = 0;
};

/// Connects triangles through edges whose two ends have exactly equal positions and UVs, across primitives
/// too. `set` is 0 or 1.
UvCharts findCharts(const Mesh& mesh, int set);

} // namespace relume
