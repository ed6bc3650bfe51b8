#pragma once

#include <functional>
#include <string>
#include <vector>

#include "app/bench/methods_report.h"
#include "assets/gltf/gltf.h"
#include "bake/baker/baker.h"
#include "bake/trace/make_tracer.h"

namespace relume {

struct MethodsBenchDesc {
    std::string scene;                       // path
    GltfChoice choice;                       // of it
    std::vector<uint32_t> sizes;             // lightmap edges [texels]
    std::vector<Method> methods;             // DFPR refers to pure: without it there is none
    std::vector<uint32_t> windows = {1};     // of static, Monte-Carlo, mipmapped
    std::vector<uint32_t> nodes = {8};       // of adaptive
    std::vector<double> thresholds = {0.05}; // of adaptive
    std::vector<uint32_t> samples = {256};   // of directional and hybrid
    bool smooth = true;                      // hybrid
    uint32_t passes = 2;                     // bounces
    uint32_t referenceSamples = 2048;        // directions per patch of the reference, made by hybrid
    double maxSeconds = 600;                 // solver time after which a bake is given up
    uint32_t pictureSize = 0;                // the size whose lightmaps are shown; 0: the largest
    CacheSettings cache;
    TracerKind tracer = TracerKind::Auto;
};

/// Bakes the scene by every method with every setting at every size and measures time and error. A bake that
/// fails or takes too long is noted in its run. `finished` is called after each. Throws Error where the
/// scene cannot be read, or on Ctrl-C.
MethodsReport benchMethods(const vk::Device& device, const MethodsBenchDesc& desc,
                           const std::function<void(const MethodRun&)>& finished);

} // namespace relume
