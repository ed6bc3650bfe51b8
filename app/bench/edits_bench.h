#pragma once

#include <functional>
#include <string>
#include <vector>

#include "app/bench/edits_report.h"
#include "assets/gltf/gltf.h"
#include "bake/baker/baker.h"
#include "bake/trace/make_tracer.h"

namespace relume {

/// Says what `relume bench edits` measures: edits of a baked scene, against baking it anew.
struct EditsBenchDesc {
    std::string scene;                            // path
    GltfChoice choice;                            // of it
    std::vector<uint32_t> lamps = {1, 8, 16, 32}; // how many there are, each > 0
    uint32_t size = 256;                          // lightmap edge [texels]
    double error = 0.02;                          // what bakes are to reach, relRMSE
    uint32_t samples = 64;                        // directions per patch where sums of layers are compared
    uint32_t referenceSamples = 4096;             // directions per patch of references
    uint32_t runs = 3;
    bool onlyLamps = true; // the scene's materials and its sky do not shine
    double batchMs = 20;   // how long one submit should take
    TracerKind tracer = TracerKind::Auto;
    std::string sceneOutput; // path for the scene after the move, with the most lamps; "": not written
};

/// Measures the edits. The lamps are first those that are added, at least one, then the scene's own. Times
/// are of step(), edit() and liveLight() by the clock, without what is done once for a scene: rasterization,
/// patches, acceleration structure. `finished` is called after each number of lamps. Throws Error where the
/// scene cannot be baked, or on Ctrl-C.
EditsReport benchEdits(const vk::Device& device, const EditsBenchDesc& desc,
                       const std::function<void(const EditsRun&)>& finished);

} // namespace relume
