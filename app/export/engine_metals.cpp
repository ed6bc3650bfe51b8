#include "app/export/engine_metals.h"

#include <cmath>
#include <map>
#include <tuple>

namespace relume {
namespace {

constexpr size_t kChannels = 4, kGreen = 1, kBlue = 2; // G roughness, B metallic

Image withEngineMetals(const Image& image, const Material& material) {
    Image out = image;
    for (size_t i = 0; i + kChannels <= out.rgba.size(); i += kChannels) {
        const float roughness = material.roughness * static_cast<float>(image.rgba[i + kGreen]) / 255.0f;
        const float metallic = material.metallic * static_cast<float>(image.rgba[i + kBlue]) / 255.0f;
        out.rgba[i + kBlue] = static_cast<uint8_t>(std::lround(255.0f * engineMetallic(metallic, roughness)));
    }
    return out;
}

} // namespace

void giveEngineMetals(Scene& scene) {
    std::map<std::tuple<int, float, float>, int> made; // textures by the old one and the factors
    for (Material& material : scene.materials) {
        const int old = material.metallicRoughnessTexture.texture;
        const int image = old >= 0 ? scene.textures[static_cast<size_t>(old)].image : -1;
        if (image < 0 || material.metallic == 0.0f) {
            material.metallic = engineMetallic(material.metallic, material.roughness);
            continue;
        }
        const auto [place, isNew] = made.try_emplace({old, material.metallic, material.roughness},
                                                     static_cast<int>(scene.textures.size()));
        if (isNew) {
            Texture texture = scene.textures[static_cast<size_t>(old)];
            texture.image = static_cast<int>(scene.images.size());
            scene.images.push_back(withEngineMetals(scene.images[static_cast<size_t>(image)], material));
            scene.textures.push_back(texture);
        }
        material.metallicRoughnessTexture.texture = place->second;
        material.metallic = 1.0f; // the texture has it
    }
}

} // namespace relume
