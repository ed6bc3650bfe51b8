#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "assets/gltf/gltf.h"
#include "bake/trace/make_tracer.h"

namespace relume {

/// Says what `relume bench reload` measures: a scene's file that another program writes anew while it is
/// baked, against the same edits made in the viewer.
struct ReloadBenchDesc {
    std::string scene;    // path
    GltfChoice choice;    // of it
    uint32_t lamps = 16;  // > 0, which light it alone
    uint32_t size = 512;  // lightmap edge [texels]
    double error = 0.02;  // what the bake is to reach, relRMSE as it is told; 0: `samples` are taken
    uint32_t samples = 0; // directions per patch, 0: as many as the error takes
    uint32_t runs = 5;    // of each edit, > 0
    uint32_t changes = 0; // random ones that come as files, one after another
    double batchMs = 8;   // how long one submit should take
    TracerKind tracer = TracerKind::Auto;
    std::string device; // as vk::Device::Desc::select
};

/// An edit as a file and as the viewer's own. Figures are medians of all runs.
struct MeasuredReload {
    std::string edit;                       // "lamp moved"
    double fileSeconds = 0;                 // from the file's last byte until its light is there
    double viewerSeconds = 0;               // from the edit until its light is there
    uint64_t fileRays = 0, viewerRays = 0;  // until the bake is done
    uint32_t layersKept = 0, layersAll = 0; // of other lights: those whose light stayed the same to the bit,
                                            // in the worst run
};

struct ReloadReport {
    std::string scene, device, tracer;
    uint32_t size = 0, patches = 0, lamps = 0;
    double readSeconds = 0; // of the file alone, median
    std::vector<MeasuredReload> edits;
    uint64_t beginnings = 0;          // how often a bake began, the first time counted
    uint32_t changes = 0;             // random ones that were followed
    std::optional<double> difference; // relRMSE after all of them against a fresh bake of the last file
};

/// Measures by the clock, with a session and a bake as the viewer has them, and without a window. The file is
/// a copy in a temporary folder. Throws Error where the scene cannot be baked, or on Ctrl-C.
ReloadReport benchReload(const ReloadBenchDesc& desc);

} // namespace relume
