#include "assets/model/panes.h"

#include <algorithm>

namespace relume {

namespace {

/// Returns the mean alpha of the texture of a use, or 1 where there is none.
float meanAlpha(const Scene& scene, const TextureRef& use) {
    if (use.texture < 0) return 1.0f;
    const int image = scene.textures[static_cast<size_t>(use.texture)].image;
    constexpr size_t kAlpha = 3;
    return image < 0 ? 1.0f
                     : static_cast<float>(meanOfChannel(scene.images[static_cast<size_t>(image)], kAlpha));
}

bool isPane(const Scene& scene, const Primitive& primitive) {
    return primitive.material >= 0 && scene.materials[static_cast<size_t>(primitive.material)].pane;
}

bool showsNothingElse(const Scene& scene) {
    return std::all_of(scene.instances.begin(), scene.instances.end(), [&](const Instance& instance) {
        if (instance.hidden || instance.mesh < 0) return true;
        const std::vector<Primitive>& primitives =
            scene.meshes[static_cast<size_t>(instance.mesh)].primitives;
        return std::all_of(primitives.begin(), primitives.end(),
                           [&](const Primitive& primitive) { return isPane(scene, primitive); });
    });
}

} // namespace

bool passesLight(const Material& material, float textureAlpha) {
    if (material.emission != glm::vec3(0.0f)) return false;
    const bool clear =
        material.alphaMode == AlphaMode::Blend && material.baseColor.a * textureAlpha < kMostAlpha;
    return clear || material.transmission > kLeastTransmission;
}

void markPanes(Scene& scene) {
    for (Material& material : scene.materials) {
        // A picture is only looked at where its alpha counts.
        const float alpha =
            material.alphaMode == AlphaMode::Blend ? meanAlpha(scene, material.baseColorTexture) : 1.0f;
        material.pane = passesLight(material, alpha);
    }
    if (!showsNothingElse(scene)) return;
    for (Material& material : scene.materials)
        material.pane = false;
}

double meanOfChannel(const Image& image, size_t channel) {
    constexpr size_t kChannels = 4;
    const size_t pixels = image.rgba.size() / kChannels;
    if (pixels == 0) return 1.0;
    uint64_t sum = 0; // exact, and the same in any order
    for (size_t i = 0; i < pixels; ++i)
        sum += image.rgba[kChannels * i + channel];
    return static_cast<double>(sum) / (255.0 * static_cast<double>(pixels));
}

} // namespace relume
