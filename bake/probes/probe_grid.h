#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

namespace relume {

/// The most probes that one bake takes: with the default number of directions these are 400 million rays, and
/// as JSON some 8 MB for each light.
constexpr uint32_t kMostProbes = 16384;

/// A regular grid of probes: probe (x, y, z) stands at first + spacing * (x, y, z).
struct ProbeGrid {
    glm::vec3 first{0.0f}; // [m]
    float spacing = 1.0f;  // [m]
    glm::uvec3 counts{1u}; // along x, y, z
};

/// Returns the grid of this spacing [m] in the middle of the box from `low` to `high` [m]: as many cells of
/// the spacing as fit along each axis, at least one, with a probe in the middle of each, so that none stands
/// on a wall of the box. Throws UsageError, which names --probes, where the box has no size or there would be
/// more than kMostProbes.
ProbeGrid planProbeGrid(const glm::vec3& low, const glm::vec3& high, float spacing);

/// Returns where the probes stand [m], x fastest, then y, then z.
std::vector<glm::vec3> probePoints(const ProbeGrid& grid);

} // namespace relume
