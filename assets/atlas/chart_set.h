#pragma once

#include <cstdint>
#include <vector>

#include "assets/atlas/chart_quality.h"
#include "assets/atlas/chart_segments.h"
#include "assets/atlas/welded_mesh.h"

namespace relume {

class WorkerPool;

/// Holds a chart while charts are still made.
struct FlatChart {
    std::vector<uint32_t> triangles;
    Stretch stretch;
    double border = 0.0; // length of the edges that are not glued [m]
    bool plane = false;  // most of it is one, which nothing that is joined to it may bend or stretch

    /// Returns the width of a long strip of the same area and border [m].
    double width() const { return border > 0.0 ? 2.0 * stretch.surface / border : 0.0; }
};

/// Holds all charts of a mesh while they are made. Charts that were joined to others are empty.
struct ChartSet {
    std::vector<FlatChart> charts;
    std::vector<glm::dvec2> uv; // per corner of the mesh [m]; each chart in a plane of its own
    std::vector<uint8_t> glued; // per half-edge: it has the same UVs as its opposite, in the same chart
};

constexpr double kMostStretch = 1.15; // L2 of a chart; that of all charts together is no larger

/// Flattens segments: planes as they are, bent ones by relaxing their projection. What turns over, covers
/// itself or stretches too far falls into its parts.
ChartSet flattenSegments(const WeldedMesh& mesh, const SegmentForest& forest, WorkerPool& pool);

/// Returns the length of the half-edges of the triangles that are not glued [m].
double borderOf(const WeldedMesh& mesh, const std::vector<uint32_t>& triangles,
                const std::vector<uint8_t>& glued);

} // namespace relume
