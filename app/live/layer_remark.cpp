#include "app/live/layer_remark.h"

#include "bake/light_buffers.h"
#include "bake/light_source.h"

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
    // Each has its direct light and its result (bake/layer.h).
    const double each = 2.0 * static_cast<double>(LightBuffers::lightBytes(baker.patches()));
    return fmt::format(
        "{} lights are baked as one, {:.0f} MiB for their layers are not free: use fewer lights or a "
        "smaller lightmap",
        lights, static_cast<double>(lights) * each / kMiB);
}

} // namespace relume
