#include "bake/probes/probe_grid.h"

#include "assets/base/error.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace relume {
namespace {

// Returns how many probes stand along each axis, as numbers that cannot overflow.
glm::dvec3 countsOf(const glm::dvec3& extent, double spacing) {
    // A cell that misses the box by a float's rounding alone counts.
    constexpr double kRounding = 1.0 + 1e-6;
    return glm::max(glm::floor(extent / spacing * kRounding), 1.0);
}

double product(const glm::dvec3& v) {
    return v.x * v.y * v.z;
}

} // namespace

ProbeGrid planProbeGrid(const glm::vec3& low, const glm::vec3& high, float spacing) {
    const glm::dvec3 extent = glm::dvec3(high) - glm::dvec3(low);
    const double longest = std::max({extent.x, extent.y, extent.z});
    if (!(longest > 0.0))
        throw UsageError("--probes: the scene has no size to lay a grid in: use --probe-at X,Y,Z");
    const glm::dvec3 counts = countsOf(extent, spacing);
    if (product(counts) > kMostProbes) {
        constexpr double kStep = 1.05;
        double fits = spacing;
        while (product(countsOf(extent, fits)) > kMostProbes)
            fits *= kStep;
        throw UsageError(
            fmt::format("--probes {}: that makes {:.0f} x {:.0f} x {:.0f} probes, more than {}: a "
                        "spacing of {:.3g} fits",
                        spacing, counts.x, counts.y, counts.z, kMostProbes, fits * kStep));
    }
    ProbeGrid grid;
    grid.spacing = spacing;
    grid.counts = glm::uvec3(counts);
    grid.first = glm::vec3(glm::dvec3(low) + 0.5 * (extent - (counts - 1.0) * double{spacing}));
    return grid;
}

std::vector<glm::vec3> probePoints(const ProbeGrid& grid) {
    std::vector<glm::vec3> points;
    points.reserve(size_t{grid.counts.x} * grid.counts.y * grid.counts.z);
    for (uint32_t z = 0; z < grid.counts.z; ++z)
        for (uint32_t y = 0; y < grid.counts.y; ++y)
            for (uint32_t x = 0; x < grid.counts.x; ++x)
                points.push_back(grid.first + grid.spacing * glm::vec3(x, y, z));
    return points;
}

} // namespace relume
