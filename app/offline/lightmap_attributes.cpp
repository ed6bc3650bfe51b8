#include "app/offline/lightmap_attributes.h"

#include "app/offline/bake_settings.h"
#include "assets/base/error.h"
#include "assets/base/log.h"
#include "assets/images/paged_image.h"

#include <fmt/format.h>

namespace relume {
namespace {

std::string attribute(const FloatImage& image, const std::string& name) {
    const auto found = image.attributes.find(name);
    return found != image.attributes.end() ? found->second : "";
}

std::string nameOf(const std::string& path) {
    return path.substr(path.find_last_of('/') + 1);
}

void warnAboutScene(const FloatImage& image, const std::string& path, const std::string& scene) {
    const std::string from = attribute(image, "relume:scene"), name = nameOf(scene);
    if (!from.empty() && from != name && attribute(image, "relume:scene-out") != name)
        spdlog::warn("{}: is a lightmap of {}, not of {}", path, from, scene);
}

} // namespace

void addLightmapAttributes(FloatImage& image, const std::string& scene, const BakeSettings& bake,
                           const LightmapDesc& lightmap, const SolverProgress& progress) {
    image.attributes["relume:version"] = RELUME_VERSION;
    image.attributes["relume:scene"] = nameOf(scene);
    image.attributes["relume:method"] = methodName(bake.solver.method);
    image.attributes["relume:quantity"] = lightmap.quantity == Quantity::Radiance ? "radiance" : "lighting";
    image.attributes["relume:settings"] =
        describeSettings(bake) +
        fmt::format(" dilate={} sew={}", lightmap.rtrad ? 1 : lightmap.dilate, lightmap.sew ? 1 : 0);
    image.attributes["relume:passes"] = std::to_string(progress.passes);
    image.attributes["relume:error"] = fmt::format("{:.6g}", progress.error);
}

void noteSceneOut(FloatImage& image, const std::string& sceneOut) {
    if (!sceneOut.empty()) image.attributes["relume:scene-out"] = nameOf(sceneOut);
}

FloatImage readLightmap(const std::string& path, const std::string& scene) {
    FloatImage image = readLightmapFile(path);
    if (attribute(image, "relume:quantity") == "radiance") {
        throw Error(path +
                    ": holds radiance, which has the albedo in it: bake it with --quantity lighting and "
                    "without --preset");
    }
    warnAboutScene(image, path, scene);
    return image;
}

void warnAboutLayers(const LayeredImage& image, const std::string& path, const std::string& scene) {
    warnAboutScene(image.composite, path, scene);
    for (const LayeredImage::Layer& layer : image.layers)
        if (const auto stale = layer.attributes.find(layer_attribute::kStale);
            stale != layer.attributes.end())
            spdlog::warn("{}: stale: {}: bake it again", path, stale->second);
}

} // namespace relume
