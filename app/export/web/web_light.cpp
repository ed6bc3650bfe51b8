#include "app/export/web/web_light.h"

#include "app/export/web/web_picture.h"
#include "app/offline/light_mix.h"
#include "assets/base/error.h"
#include "assets/images/image_file.h"
#include "assets/images/shared_exponent.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace relume {
namespace {

using nlohmann::json;

constexpr float kCovered = 0.75f; // coverage: above it a patch, below filled or empty
constexpr int kHighest = 15;      // the brightest texel of a layer is below 2 to the power of it
constexpr size_t kMostFrames = 48;

std::string attribute(const LayeredImage::Layer& layer, const char* name) {
    const auto found = layer.attributes.find(name);
    return found == layer.attributes.end() ? "" : found->second;
}

json threeOf(const glm::vec3& v) {
    return {v.x, v.y, v.z};
}

struct Texels {
    std::vector<uint32_t> packed;
    glm::dvec3 mean{0.0}; // of the patches [cd/m^2], at a weight of 1
    int exponent = 0;     // the light of a texel is its number times 2 to the power of it
};

Texels texelsOf(const LayeredImage::Layer& layer, const std::vector<float>& coverage,
                const std::string& name) {
    const std::vector<float>* planes[3] = {layer.image.find("R"), layer.image.find("G"),
                                           layer.image.find("B")};
    Texels texels;
    float most = 0.0f;
    double count = 0;
    std::vector<glm::vec3> light(coverage.size(), glm::vec3(0.0f));
    for (size_t i = 0; i < light.size(); ++i) {
        const glm::vec3 texel((*planes[0])[i], (*planes[1])[i], (*planes[2])[i]);
        if (!std::isfinite(texel.x + texel.y + texel.z))
            throw Error(fmt::format("{}: the layer of '{}' holds a value that is not finite: bake it again",
                                    name, layer.name));
        if (coverage[i] <= 0.0f) continue; // nothing may come out of empty texels
        light[i] = glm::max(texel, 0.0f);
        most = std::max({most, light[i].x, light[i].y, light[i].z});
        if (coverage[i] < kCovered) continue;
        texels.mean += glm::dvec3(light[i]);
        count += 1;
    }
    if (count > 0) texels.mean /= count;
    if (most > 0.0f) texels.exponent = std::ilogb(most) + 1 - kHighest;
    texels.packed.reserve(light.size());
    for (const glm::vec3& texel : light)
        texels.packed.push_back(
            packSharedExponent({std::ldexp(texel.x, -texels.exponent), std::ldexp(texel.y, -texels.exponent),
                                std::ldexp(texel.z, -texels.exponent)}));
    return texels;
}

} // namespace

LightLayers::LightLayers(const Scene& scene, const LayeredImage& image) {
    std::map<std::string, int> named;
    for (size_t i = 0; i < image.layers.size(); ++i) {
        const std::vector<std::string> members = membersOf(image.layers[i]);
        for (const std::string& member : members)
            named[member] = static_cast<int>(i);
        if (members.empty()) named[image.layers[i].name] = static_cast<int>(i);
    }
    for (const LightSource& source : lightSources(scene))
        if (const auto found = named.find(source.name); found != named.end())
            numbers_[source.key] = found->second;
}

int LightLayers::of(const LightKey& key) const {
    const auto found = numbers_.find(key);
    return found == numbers_.end() ? -1 : found->second;
}

void addLight(WebContainer& to, const LayeredImage& image, const std::string& name) {
    const FloatImage& composite = image.composite;
    if (composite.width != composite.height || composite.width == 0)
        throw Error(fmt::format("{}: has {} x {} texels, and a lightmap is a square: bake one", name,
                                composite.width, composite.height));
    const size_t count = size_t{composite.width} * composite.height;
    const std::vector<float>* covered = composite.find("coverage");
    const std::vector<float> coverage = covered ? *covered : std::vector<float>(count, 1.0f);
    std::vector<uint8_t> eighths(count);
    for (size_t i = 0; i < count; ++i)
        eighths[i] = coverage[i] > 0.0f
                         ? static_cast<uint8_t>(std::clamp(std::lround(255.0f * coverage[i]), 1l, 255l))
                         : uint8_t{0};
    to.header["lightmap"] = {{"size", composite.width},
                             {"coverage", to.addValues(std::span<const uint8_t>(eighths))}};
    json& lights = to.header["lights"] = json::array();
    for (const LayeredImage::Layer& layer : image.layers) {
        const Texels texels = texelsOf(layer, coverage, name);
        lights.push_back({{"name", layer.name},
                          {"type", attribute(layer, layer_attribute::kType)},
                          {"unit", attribute(layer, layer_attribute::kUnit)},
                          {"stale", attribute(layer, layer_attribute::kStale)},
                          {"members", membersOf(layer)},
                          {"intensity", intensityOf(layer)},
                          {"color", threeOf(colorOf(layer))},
                          {"weight", threeOf(layer.weight)},
                          {"mean", {texels.mean.x, texels.mean.y, texels.mean.z}},
                          {"exponent", texels.exponent},
                          {"texels", to.addValues(std::span<const uint32_t>(texels.packed))}});
    }
}

std::vector<size_t> evenlySpread(size_t count, size_t most) {
    ASSERT(most >= 2);
    std::vector<size_t> taken;
    const size_t some = std::min(count, most);
    for (size_t i = 0; i < some; ++i)
        taken.push_back(some == count ? i : (i * (count - 1) + (some - 1) / 2) / (some - 1));
    return taken;
}

void addFrames(WebContainer& to, const std::vector<std::string>& paths) {
    json& frames = to.header["frames"] = json::array();
    for (const size_t i : evenlySpread(paths.size(), kMostFrames)) {
        const FloatImage frame = readImage(paths[i]);
        frames.push_back({{"number", i + 1}, {"picture", to.add(smallWebpOf(frame, paths[i]))}});
    }
}

} // namespace relume
