#include "app/offline/layer_file.h"

#include "app/offline/light_mix.h"
#include "app/offline/name_lines.h"
#include "assets/base/error.h"
#include "assets/base/log.h"
#include "assets/images/paged_image.h"
#include "assets/model/light_names.h"
#include "bake/output/layer_sum.h"

#include <algorithm>

#include <fmt/format.h>

namespace relume {
namespace {

struct LightText {
    std::string type, unit;
    float intensity = 0.0f;
    glm::vec3 color{1.0f};
};

LightText describe(const Scene& scene, const LightKey& key) {
    if (key.kind == LightKey::Kind::Lamp) {
        const Light& light = scene.lights[key.index];
        return {lightTypeName(light.type), lightUnit(light.type), light.intensity, light.color};
    }
    if (key.kind == LightKey::Kind::Group) return {"group", "", 1.0f, glm::vec3(1.0f)};
    const bool sky = key.kind == LightKey::Kind::Sky;
    const glm::vec3 radiance = sky ? scene.sky.radiance : scene.materials[key.material].emission;
    const float most = std::max({radiance.r, radiance.g, radiance.b});
    return {sky ? "sky" : "emitter", "cd/m^2", most, most > 0.0f ? radiance / most : glm::vec3(1.0f)};
}

std::string namesOf(const std::vector<LightSource>& lights) {
    std::vector<std::string> names;
    for (const LightSource& light : lights)
        names.push_back(light.name);
    return joinedLines(names);
}

// Returns Baker::lightmap without making all layers' images again.
FloatImage lightmapOf(const Baker& baker, const LightmapDesc& desc,
                      const std::vector<LayeredImage::Layer>& layers) {
    if (layers.empty() || !baker.sumsLayers(desc)) return baker.lightmap(desc);
    FloatImage composite = layers.front().image;
    LayerSum sum(baker.workers(), composite.width, composite.height);
    for (const LayeredImage::Layer& layer : layers)
        sum.add(layer.weight, layer.image);
    sum.writeTo(composite);
    requireFiniteTexels(composite);
    return composite;
}

} // namespace

LayeredImage::Layer layerWithoutImage(const Scene& scene, const Layer& layer) {
    const LightText light = describe(scene, layer.source.key);
    LayeredImage::Layer part{layer.source.name, layer.source.weight, {}, {}};
    part.attributes[layer_attribute::kType] = light.type;
    part.attributes[layer_attribute::kUnit] = light.unit;
    part.attributes[layer_attribute::kIntensity] = fmt::format("{}", light.intensity);
    part.attributes[layer_attribute::kColor] =
        fmt::format("{},{},{}", light.color.r, light.color.g, light.color.b);
    if (!layer.members.empty()) part.attributes[layer_attribute::kMembers] = namesOf(layer.members);
    const std::string stale = staleReason(layer);
    if (!stale.empty()) part.attributes[layer_attribute::kStale] = stale;
    const Layer* shown = layer.shown();
    if (shown) {
        part.attributes["relume:level"] =
            fmt::format("direct sample passes={} link sample passes={}", shown->level.directSamplePasses,
                        shown->level.linkSamplePasses);
        part.attributes["relume:error"] = fmt::format("{:.6g}", shown->error);
    }
    return part;
}

LayeredImage layeredImage(const Baker& baker, const Scene& scene, const LightmapDesc& desc) {
    ASSERT(desc.quantity == Quantity::Lighting);
    ASSERT(baker.layers() != nullptr);
    const LayerSolver& solver = *baker.layers();
    LayeredImage image;
    LightmapDesc each = desc;
    each.pool = &baker.workers();
    std::vector<glm::vec4> light; // of one layer after the other
    for (const std::unique_ptr<Layer>& layer : solver.layers()) {
        LayeredImage::Layer part = layerWithoutImage(scene, *layer);
        const Layer* shown = layer->shown();
        light = solver.layerLight(shown ? *shown : *layer, std::move(light));
        part.image = makeLightmap(baker.patches(), light, each);
        image.layers.push_back(std::move(part));
    }
    image.composite = lightmapOf(baker, desc, image.layers);
    return image;
}

void fitTo(const std::string& path, LayeredImage& image, ExrType type) {
    if (type == ExrType::Float) return;
    roundLayers(path, image, type);
    mixLayers(image, {});
}

void writeLayers(const std::string& path, const LayeredImage& image, ExrType type,
                 ExrCompression compression) {
    writeLayeredLightmap(path, image, type, compression);
    for (const LayeredImage::Layer& layer : image.layers) {
        const auto error = layer.attributes.find("relume:error");
        spdlog::info("layer '{}': {}", layer.name,
                     error == layer.attributes.end() ? "off, not baked" : "error " + error->second);
    }
}

std::vector<std::string> staleReasons(const LayerSolver& solver) {
    std::vector<std::string> reasons;
    for (const std::unique_ptr<Layer>& layer : solver.layers())
        if (std::string reason = staleReason(*layer); !reason.empty()) reasons.push_back(std::move(reason));
    return reasons;
}

std::string staleLayers(const LayerSolver& solver) {
    std::string text;
    for (const std::string& reason : staleReasons(solver))
        text += (text.empty() ? "" : "; ") + reason;
    return text;
}

} // namespace relume
