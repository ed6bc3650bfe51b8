#pragma once

#include <vector>

#include <glm/glm.hpp>

#include "assets/atlas/planar_charts.h"

namespace relume {

class WorkerPool;

/// Cuts triangles, given by three corners each [m], into charts that lie flat: planes as they are, curved
/// surfaces with an L2 stretch of at most 1.15, developable ones unrolled, small parts joined to their
/// neighbours. No chart covers itself and no triangle is turned over. Triangles without area are in no chart.
/// It works for any input: open, not manifold, self-intersecting, of any scale, and makes the same charts on
/// any number of threads. `texel` is about the size of a texel [m], 0: unknown; charts that are narrower than
/// some texels are joined to each other over creases, too. Where most of a chart's border runs in two
/// directions at right angles, these are those of its box; elsewhere its box has the least area.
std::vector<PlanarChart> cutCharts(const std::vector<glm::dvec3>& corners, double texel, WorkerPool& pool);

} // namespace relume
