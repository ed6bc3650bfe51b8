#include "app/live/layer_remark.h"

#include "bake/lights/light_source.h"
#include "bake/surface/light_buffers.h"

#include <algorithm>

#include <fmt/format.h>

namespace relume {

std::string layerRemark(bool wanted, const SolverSettings& settings, const Baker& baker, const Scene& scene) {
    if (!wanted) return "";
    if (!settings.layers.on)
        return fmt::format(
            "{} has no layer for each light as it is set: choose hybrid with Sobol directions, no "
            "footprint and the indirect scale 1",
            settings.transport.rtrad ? "RTRad's preset" : methodName(settings.method));
    constexpr double kMiB = 1024.0 * 1024.0;
    const size_t lights = lightSources(scene).size();
    // Each layer has its direct light and its result (bake/layers/layer.h).
    const double each = 2.0 * static_cast<double>(LightBuffers::lightBytes(baker.patches()));
    return fmt::format(
        "{} lights are baked as one, {:.0f} MiB for their layers are not free: use fewer lights or a "
        "smaller lightmap",
        lights, static_cast<double>(std::min<uint64_t>(lights, kLeastRoom)) * each / kMiB);
}

std::vector<LightGroup> groupsOf(const LayerSolver& solver) {
    std::vector<LightGroup> groups;
    for (const std::unique_ptr<Layer>& layer : solver.layers())
        if (!layer->members.empty()) groups.push_back({layer->source, layer->members});
    return groups;
}

std::string groupRemark(const std::vector<LightGroup>& groups) {
    std::string text;
    for (const LightGroup& group : groups)
        text += fmt::format("{}'{}' ({} lights)", text.empty() ? "" : " and ", group.source.name,
                            group.members.size());
    if (text.empty()) return "";
    return fmt::format(
        "lights share layers, for memory is short: {}. An edit of one makes its layer anew: use "
        "fewer lights, a smaller lightmap or more --layer-memory",
        text);
}

} // namespace relume
