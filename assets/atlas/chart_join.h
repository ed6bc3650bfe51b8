#pragma once

#include "assets/atlas/chart_set.h"

namespace relume {

/// Joins charts to their neighbours as long as what comes of two lies flat: it turns nothing over, covers
/// nothing twice and stays within kMostStretch. Where the common border has the same shape in both, one is
/// moved to the other as it is; otherwise both are relaxed together. Creases of 60 degrees stay borders, but
/// between charts that both are narrower than some texels. `texel` is the expected size of a texel [m]; 0:
/// unknown, no chart is called narrow. Two wide charts are not joined by way of a narrow one, so that the
/// sides of a thin wall stay apart.
void joinCharts(const WeldedMesh& mesh, double texel, WorkerPool& pool, ChartSet& set);

} // namespace relume
