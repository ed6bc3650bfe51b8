#include "app/export/any_scene.h"

#include "assets/base/error.h"
#include "assets/images/float_image.h"

#include <algorithm>
#include <cmath>

namespace relume {
namespace {

constexpr int kLightmapSet = 1; // TEXCOORD_1

// Light as a picture of 8 bits, in shares of its brightest channel.
struct EmissionPicture {
    Image image;
    float brightest = 0.0f; // [cd/m^2]
};

EmissionPicture pictureOf(std::vector<glm::vec3> light, const std::vector<bool>& counts,
                          const std::vector<bool>& has, const SurfaceLight& surfaces,
                          const std::string& name) {
    EmissionPicture out;
    for (size_t i = 0; i < light.size(); ++i)
        if (counts[i]) out.brightest = std::max({out.brightest, light[i].r, light[i].g, light[i].b});
    fillBetween(light, has, surfaces.size, surfaces.rings);
    out.image = {name, surfaces.size, surfaces.size, std::vector<uint8_t>(4 * light.size(), 255)};
    const float scale = out.brightest > 0.0f ? 1.0f / out.brightest : 0.0f;
    for (size_t i = 0; i < light.size(); ++i)
        for (int c = 0; c < 3; ++c) {
            const double share = std::clamp(static_cast<double>(light[i][c] * scale), 0.0, 1.0);
            out.image.rgba[4 * i + static_cast<size_t>(c)] =
                static_cast<uint8_t>(std::lround(255.0 * srgbFromLinear(share)));
        }
    return out;
}

int addTexture(Scene& scene, Image image) {
    scene.textures.push_back({.image = static_cast<int>(scene.images.size()),
                              .wrapS = Wrap::ClampToEdge,
                              .wrapT = Wrap::ClampToEdge});
    scene.images.push_back(std::move(image));
    return static_cast<int>(scene.textures.size()) - 1;
}

bool shines(const Material& material) {
    return material.emission != glm::vec3(0.0f);
}

// Leaves of a material what says where it has holes.
void reflectNothing(Material& material) {
    material.baseColor = glm::vec4(0.0f, 0.0f, 0.0f, material.baseColor.a);
    if (material.alphaMode == AlphaMode::Opaque) material.baseColorTexture = {};
    material.metallicRoughnessTexture = {};
    material.normalMap = {};
    material.metallic = 0.0f;
    material.roughness = 1.0f;
}

} // namespace

std::vector<int> lightByEmission(EngineScene& level, const SurfaceLight& light,
                                 const std::vector<Material>& originals, float exposure) {
    const size_t count = light.reflected.size();
    std::vector<bool> has(count), dull(count), shining(count);
    std::vector<glm::vec3> sum(count);
    for (size_t i = 0; i < count; ++i) {
        has[i] = light.material[i] != 0;
        const size_t number = has[i] ? light.material[i] - 1 : originals.size();
        shining[i] = number < originals.size() && shines(originals[number]);
        dull[i] = has[i] && !shining[i];
        sum[i] = light.reflected[i] + light.emitted[i];
    }
    Scene& scene = level.scene;
    EmissionPicture dim = pictureOf(light.reflected, dull, has, light, "Light");
    EmissionPicture bright = pictureOf(std::move(sum), shining, has, light, "Light of what shines");
    const int dimTexture = addTexture(scene, std::move(dim.image));
    const int brightTexture = bright.brightest > 0.0f ? addTexture(scene, std::move(bright.image)) : -1;
    const float factor = std::exp2(exposure);
    for (size_t i = 0; i < scene.materials.size(); ++i) {
        Material& material = scene.materials[i];
        if (material.pane) {
            material.emission *= factor;
            // A pane that transmits tints what is behind it by its colour. One that blends shows the light
            // that it has, and would be brighter by that of a viewer's surroundings.
            if (material.transmission <= 0.0f) reflectNothing(material);
            continue;
        }
        if (level.lit[i]) {
            const bool own = shines(material) && brightTexture >= 0;
            material.emission = glm::vec3((own ? bright.brightest : dim.brightest) * factor);
            material.emissionTexture = {.texture = own ? brightTexture : dimTexture,
                                        .texCoord = kLightmapSet};
        } else {
            material.emission *= factor;
        }
        reflectNothing(material);
    }
    dropUnusedTextures(scene);
    std::vector<int> maps;
    for (size_t i = 0; i < scene.materials.size(); ++i) {
        const int texture = scene.materials[i].emissionTexture.texture;
        if (level.lit[i] && texture >= 0 && std::find(maps.begin(), maps.end(), texture) == maps.end())
            maps.push_back(texture);
    }
    return maps;
}

} // namespace relume
