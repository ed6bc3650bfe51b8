#pragma once

#include <functional>
#include <string>
#include <vector>

#include "app/bench/quality/quality_report.h"
#include "assets/gltf/gltf.h"
#include "bake/baker/baker.h"

namespace relume {

struct QualityBenchDesc {
    std::string scene; // path
    GltfChoice choice;
    uint32_t size = 256; // lightmap edge [texels]
    std::vector<std::string> modes = {"plain", "layers", "per-chunk", "uniform"};
    double error = 0.01, localError = 0.05; // at which bakes end, as they tell them; 0: not asked for
    double seconds = 600;                   // of the solver, after which a bake is ended
    double rays = 0;                        // and so many; 0: any number
    uint32_t referenceSamples = 4096;
    std::string reference; // .exr: read, or made and written where it is missing; "": made
    std::string pictures;  // folder; "": pictures are not written
    bool flip = true;      // pictures are compared, which needs OpenGL
    double batchMs = 20;   // aim of one submit
    TracerKind tracer = TracerKind::Auto;
};

/// Bakes the scene in each mode and measures how good it is on its way: whenever its rays have doubled since
/// the last look and a sample pass is finished, and at its end. Looking takes no time of what is measured.
/// `finished` is called after each bake. After Ctrl-C the report holds what there is, if any bake had begun.
/// Throws Error.
QualityReport benchQuality(const vk::Device& device, const QualityBenchDesc& desc,
                           const std::function<void(const QualityRun&)>& finished);

} // namespace relume
