#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "assets/atlas/world_mesh.h"
#include "bake/base/shader_types.h"

namespace relume {

/// The data on the CPU that every tracer is built from: triangles, patches in tile order and the tables that
/// turn a hit into a patch. It outlives its tracers, which Tracer::update() tells when it changes.
struct TraceScene {
    WorldMesh mesh;
    uint32_t size = 0;                  // edge of the sheet of all pages [texels]
    bool rtrad = false;                 // RTRad's ray intervals (--preset rtrad)
    std::vector<shader::Patch> patches; // tile order, padded with patches that send nothing to whole chunks
    std::vector<uint32_t> patchChart;   // per patch; kNoChart for padding and back sides
    std::vector<uint32_t> texelToPatch; // [size * size], kNoPatch where empty
    std::vector<shader::HitTriangle> hitTriangles; // per triangle of mesh
    // The masked triangles in order: triangle t has entry t - mesh.opaqueCount.
    std::vector<shader::AlphaTriangle> alphaTriangles;
    std::vector<shader::AlphaMaterial> alphaMaterials;
    std::vector<uint8_t> alphaTexels; // 8-bit alpha of all masked textures

    uint32_t pageSize() const { return mesh.pages.edgeOf(size); } // [texels]
    /// Returns the chart whose hits may end at this patch: kNoChart where it sends nothing.
    uint32_t sendingChart(uint32_t patch) const {
        return (patches[patch].flags & shader::kPatchSends) != 0 ? patchChart[patch] : kNoChart;
    }
    std::vector<uint32_t> sendingCharts() const { // of all patches
        std::vector<uint32_t> charts(patchChart.size());
        for (uint32_t patch = 0; patch < charts.size(); ++patch)
            charts[patch] = sendingChart(patch);
        return charts;
    }
    uint32_t chunkCount() const { return static_cast<uint32_t>(patches.size() / shader::kChunk); }
};

} // namespace relume
