#include "app/offline/light_mix.h"

#include "app/edit/scene_property.h"
#include "app/offline/name_lines.h"
#include "app/text/near_names.h"
#include "app/text/typed_numbers.h"
#include "assets/base/error.h"
#include "assets/base/warnings.h"
#include "bake/output/layer_sum.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace relume {
namespace {

constexpr const char* kForm = "write NAME=INTENSITY[,COLOR] or NAME*=FACTOR";

float brightest(const glm::vec3& v) {
    return std::max({v.x, v.y, v.z});
}

float numberIn(std::string_view text) {
    const Setting setting = settingOf(Property::Intensity, text);
    requireGood(setting);
    return std::get<float>(setting.value);
}

glm::vec3 colorIn(std::string_view text) {
    const Setting setting = settingOf(Property::Color, text);
    requireGood(setting);
    return std::get<glm::vec3>(setting.value);
}

LayeredImage::Layer& layerOf(LayeredImage& image, const std::string& name) {
    std::vector<std::string> names;
    for (LayeredImage::Layer& layer : image.layers) {
        if (layer.name == name) return layer;
        names.push_back(layer.name);
    }
    for (const LayeredImage::Layer& layer : image.layers) {
        const std::vector<std::string> members = membersOf(layer);
        if (std::find(members.begin(), members.end(), name) != members.end())
            throw Error(fmt::format("light {0} is part of {1} and cannot be set apart: set {1}, or bake with "
                                    "more --layer-memory",
                                    inQuotes(name), inQuotes(layer.name)));
    }
    throw Error(fmt::format("no light is called {}: {}", inQuotes(name), nearNamesHint(name, names)));
}

void remember(LayeredImage::Layer& layer, float intensity, const glm::vec3& color) {
    layer.attributes[layer_attribute::kIntensity] = fmt::format("{}", intensity);
    layer.attributes[layer_attribute::kColor] = fmt::format("{},{},{}", color.r, color.g, color.b);
}

void weigh(LayeredImage::Layer& layer, float intensity, const glm::vec3& color) {
    layer.weight = color * intensity;
    for (int c = 0; c < 3; ++c)
        if (!std::isfinite(layer.weight[c]))
            throw UsageError(
                fmt::format("light {} becomes too bright: give a smaller number", inQuotes(layer.name)));
    remember(layer, intensity, color);
}

void turnOff(LayeredImage::Layer& layer) {
    remember(layer, intensityOf(layer), colorOf(layer));
    layer.weight = glm::vec3(0.0f);
}

std::vector<glm::vec3> weightsOf(const LayeredImage& image) {
    std::vector<glm::vec3> weights;
    for (const LayeredImage::Layer& layer : image.layers)
        weights.push_back(layer.weight);
    return weights;
}

// Drops the channels that are no sum of layers, such as an error per texel: they are not those of the new
// sum.
void keepSummedChannels(FloatImage& image) {
    for (size_t c = image.channels.size(); c-- > 0;) {
        const std::string& name = image.channels[c];
        if (name == "R" || name == "G" || name == "B" || name == "coverage") continue;
        image.channels.erase(image.channels.begin() + static_cast<std::ptrdiff_t>(c));
        image.planes.erase(image.planes.begin() + static_cast<std::ptrdiff_t>(c));
    }
}

void sum(LayeredImage& image) {
    WorkerPool pool(0);
    LayerSum sum(pool, image.composite.width, image.composite.height);
    for (const LayeredImage::Layer& layer : image.layers)
        sum.add(layer.weight, layer.image);
    keepSummedChannels(image.composite);
    sum.writeTo(image.composite);
}

} // namespace

WeightEdit weightEditOf(std::string_view text) {
    const size_t equals = text.rfind('=');
    if (equals == std::string_view::npos) throw UsageError(kForm);
    WeightEdit edit;
    std::string_view name = text.substr(0, equals), value = text.substr(equals + 1);
    edit.isFactor = name.ends_with('*');
    if (edit.isFactor) name.remove_suffix(1);
    if (name.empty()) throw UsageError(kForm);
    edit.name = name;
    const size_t comma = value.find(',');
    if (edit.isFactor && comma != std::string_view::npos) throw UsageError(kForm);
    edit.intensity = numberIn(value.substr(0, comma));
    if (comma != std::string_view::npos) edit.color = colorIn(value.substr(comma + 1));
    return edit;
}

std::vector<std::string> membersOf(const LayeredImage::Layer& layer) {
    const auto found = layer.attributes.find(layer_attribute::kMembers);
    return found == layer.attributes.end() ? std::vector<std::string>() : namesIn(found->second);
}

float intensityOf(const LayeredImage::Layer& layer) {
    const auto found = layer.attributes.find(layer_attribute::kIntensity);
    if (found != layer.attributes.end())
        if (const std::optional<float> number = typedNumber(found->second)) return *number;
    return brightest(layer.weight);
}

glm::vec3 colorOf(const LayeredImage::Layer& layer) {
    const auto found = layer.attributes.find(layer_attribute::kColor);
    if (found != layer.attributes.end()) {
        const std::vector<float> rgb = typedNumbers(found->second, 3);
        if (!rgb.empty()) return {rgb[0], rgb[1], rgb[2]};
    }
    const float intensity = intensityOf(layer);
    return intensity > 0.0f && brightest(layer.weight) > 0.0f ? layer.weight / intensity : glm::vec3(1.0f);
}

void mixLayers(LayeredImage& image, const MixDesc& desc) {
    const std::vector<glm::vec3> before = weightsOf(image);
    for (const WeightEdit& edit : desc.edits) {
        LayeredImage::Layer& layer = layerOf(image, edit.name);
        if (edit.isFactor) {
            const glm::vec3 weight = layer.weight * edit.intensity; // a layer that is off stays off
            weigh(layer, intensityOf(layer) * edit.intensity, colorOf(layer));
            layer.weight = weight;
        } else {
            weigh(layer, edit.intensity, edit.color.value_or(colorOf(layer)));
        }
    }
    for (const std::string& name : desc.solo)
        layerOf(image, name);
    for (LayeredImage::Layer& layer : image.layers) {
        const bool alone =
            desc.solo.empty() || std::find(desc.solo.begin(), desc.solo.end(), layer.name) != desc.solo.end();
        if (!alone) turnOff(layer);
    }
    for (const std::string& name : desc.muted)
        turnOff(layerOf(image, name));
    // It is told of the sum by the weights of the bake: that of noisy lights alone may be ten times as large.
    if (weightsOf(image) != before) image.composite.attributes.erase("relume:error");
    sum(image);
}

} // namespace relume
