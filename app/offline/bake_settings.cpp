#include "app/offline/bake_settings.h"

#include "bake/trace/make_tracer.h"

#include <fmt/format.h>

namespace relume {
namespace {

// Every struct is taken apart by name: one more setting does not compile until it is decided here whether it
// changes a bake's bytes.

std::string describe(const TransportSettings& settings) {
    const auto& [reflectivity, distanceFactor, rtrad, allSend, deviceGather, reflectedOnly] = settings;
    return fmt::format(" reflectivity={} distance-factor={} preset={} device-gather={}", reflectivity,
                       distanceFactor, rtrad ? "rtrad" : "none", deviceGather ? 1 : 0);
}

std::string describe(Method method, const PairSettings& settings) {
    const auto& [window, threshold, node, thresholdRamp] = settings;
    if (method == Method::Adaptive)
        return fmt::format(" threshold={} node={} threshold-ramp={}", threshold, node, thresholdRamp);
    return method == Method::Pure ? "" : fmt::format(" window={}", window);
}

std::string describe(const LinkSettings& settings) {
    const auto& [directions, rotation, samples, smooth, indirectScale, footprint, allOver, perChunk,
                 uniform] = settings;
    (void)uniform; // only benches bake so, which write no lightmap
    return fmt::format(
        " samples={} indirect-scale={} smooth={} footprint={} points={} per-chunk={} directions={} rotate={}",
        samples, indirectScale, smooth ? 1 : 0, footprint ? 1 : 0, allOver ? "texel" : "centre",
        perChunk ? 1 : 0, directions == DirectionSet::Lec ? "lec" : "sobol",
        rotation == Rotation::Interleaved ? "interleaved"
        : rotation == Rotation::Tile      ? "tile"
                                          : "patch");
}

} // namespace

std::string describeSettings(const BakeSettings& settings) {
    // Probes change nothing of a lightmap, and neither does the number of processes that bake it.
    const auto& [size, conservative, tracer, voxels, solver, probes, ranks] = settings;
    (void)probes, (void)ranks;
    const auto& [resolution, ratio] = voxels;
    const bool marches = ratio > 0 || tracer == TracerKind::Voxel;
    const auto& [method, layers, pairs, links, cache, transport, passes, error, localError, batchMs, live,
                 spill] = solver;
    return fmt::format(
        "size={} passes={} error={} local-error={} method={}{} conservative={} voxels={} voxel-ratio={}{}{}",
        size, passes, error, localError, methodName(method),
        layers.on ? fmt::format(" layers=1 layer-error={}", layers.error) : "", conservative ? 1 : 0,
        marches ? resolution : 0, ratio, describe(transport),
        isPairMethod(method) ? describe(method, pairs) : describe(links));
}

} // namespace relume
