#include "app/offline/lightmap_attributes.h"

#include "app/offline/bake_settings.h"

#include <fmt/format.h>

namespace relume {

void addLightmapAttributes(FloatImage& image, const std::string& scene, const BakeSettings& bake,
                           const LightmapDesc& lightmap, const SolverProgress& progress) {
    image.attributes["relume:version"] = RELUME_VERSION;
    image.attributes["relume:scene"] = scene.substr(scene.find_last_of('/') + 1);
    image.attributes["relume:method"] = methodName(bake.solver.method);
    image.attributes["relume:quantity"] = lightmap.quantity == Quantity::Radiance ? "radiance" : "lighting";
    image.attributes["relume:settings"] =
        describeSettings(bake) +
        fmt::format(" dilate={} sew={}", lightmap.rtrad ? 1 : lightmap.dilate, lightmap.sew ? 1 : 0);
    image.attributes["relume:passes"] = std::to_string(progress.passes);
    image.attributes["relume:error"] = fmt::format("{:.6g}", progress.error);
}

} // namespace relume
