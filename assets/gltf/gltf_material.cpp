#include "assets/gltf/gltf_build.h"

#include "assets/base/error.h"
#include "assets/base/watch.h"
#include "assets/model/scene_limits.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace relume::gltf {

namespace {

/// Builds materials and, on first use, the textures and images they name.
class MaterialBuilder {
public:
    explicit MaterialBuilder(Build& build)
        : build_(build), textureIndex_(build.model.textures.size(), -1),
          imageIndex_(build.model.images.size(), -1) {}
    Material material(const tinygltf::Material& source);

private:
    TextureRef reference(const tinygltf::TextureInfo& info);
    int texture(int source);
    int image(int source);

    Build& build_;
    std::vector<int> textureIndex_, imageIndex_; // of the file -> of the scene, -1: not used yet
};

std::string nameOf(const std::string& kind, const std::string& name, size_t index) {
    return name.empty() ? fmt::format("{} {}", kind, index) : kind + " " + inQuotes(name);
}

Wrap wrapOf(int value) {
    if (value == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE) return Wrap::ClampToEdge;
    if (value == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT) return Wrap::MirroredRepeat;
    return Wrap::Repeat;
}

glm::vec2 pairOr(const tinygltf::Value& value, const char* key, glm::vec2 fallback) {
    if (!value.IsObject() || !value.Has(key)) return fallback;
    const tinygltf::Value& array = value.Get(key);
    if (!array.IsArray() || array.ArrayLen() != 2 || !array.Get(0).IsNumber() || !array.Get(1).IsNumber())
        return fallback;
    return {static_cast<float>(array.Get(0).GetNumberAsDouble()),
            static_cast<float>(array.Get(1).GetNumberAsDouble())};
}

/// Returns the matrix of KHR_texture_transform: translation * rotation * scale, the rotation
/// counter-clockwise with v pointing down.
glm::mat3 transformMatrix(const tinygltf::Value& extension) {
    const glm::vec2 offset = pairOr(extension, "offset", glm::vec2(0.0f));
    const glm::vec2 scale = pairOr(extension, "scale", glm::vec2(1.0f));
    const double angle = numberOr(extension, "rotation", 0.0);
    const float c = static_cast<float>(std::cos(angle)), s = static_cast<float>(std::sin(angle));
    const glm::mat3 rotation(c, -s, 0.0f, s, c, 0.0f, 0.0f, 0.0f, 1.0f);
    glm::mat3 translation(1.0f), scaling(1.0f);
    translation[2] = glm::vec3(offset, 1.0f);
    scaling[0][0] = scale.x;
    scaling[1][1] = scale.y;
    return translation * rotation * scaling;
}

int MaterialBuilder::image(int source) {
    int& known = imageIndex_[static_cast<size_t>(source)];
    if (known >= 0) return known;
    tellWatch("loading");
    build_.scene.images.push_back(decodeImage(build_, source));
    return known = static_cast<int>(build_.scene.images.size()) - 1;
}

int MaterialBuilder::texture(int source) {
    int& known = textureIndex_[static_cast<size_t>(source)];
    if (known >= 0) return known;
    const tinygltf::Texture& from = build_.model.textures[static_cast<size_t>(source)];
    if (from.source < 0)
        throw Error(fmt::format("{}: texture {} has no PNG or JPEG image: export textures as PNG or JPEG",
                                build_.path, source));
    Texture texture;
    texture.image = image(from.source);
    if (from.sampler >= 0) {
        const tinygltf::Sampler& sampler = build_.model.samplers[static_cast<size_t>(from.sampler)];
        texture.wrapS = wrapOf(sampler.wrapS);
        texture.wrapT = wrapOf(sampler.wrapT);
        texture.nearest = sampler.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST;
    }
    build_.scene.textures.push_back(texture);
    return known = static_cast<int>(build_.scene.textures.size()) - 1;
}

TextureRef MaterialBuilder::reference(const tinygltf::TextureInfo& info) {
    TextureRef ref;
    if (info.index < 0) return ref;
    ref.texture = texture(info.index);
    ref.texCoord = info.texCoord;
    const auto extension = info.extensions.find("KHR_texture_transform");
    if (extension != info.extensions.end()) {
        ref.transform = transformMatrix(extension->second);
        const double texCoord = numberOr(extension->second, "texCoord", ref.texCoord);
        ref.texCoord = texCoord >= 0.0 && texCoord < 1e6 ? static_cast<int>(texCoord) : 0;
    }
    if (ref.texCoord > 1) {
        build_.warnings.add(fmt::format("texture {}", info.index),
                            "uses TEXCOORD_2 or higher, TEXCOORD_0 is taken");
        ref.texCoord = 0;
    }
    return ref;
}

float bounded(double value, double low, double high) {
    return std::isfinite(value) ? static_cast<float>(std::clamp(value, low, high)) : static_cast<float>(low);
}

Material MaterialBuilder::material(const tinygltf::Material& source) {
    const tinygltf::PbrMetallicRoughness& pbr = source.pbrMetallicRoughness;
    Material material;
    material.name = source.name;
    for (int c = 0; c < 4; ++c)
        material.baseColor[c] = bounded(pbr.baseColorFactor[static_cast<size_t>(c)], 0.0, 1.0);
    material.baseColorTexture = reference(pbr.baseColorTexture);
    double strength = 1.0;
    const auto extension = source.extensions.find("KHR_materials_emissive_strength");
    if (extension != source.extensions.end()) strength = numberOr(extension->second, "emissiveStrength", 1.0);
    for (int c = 0; c < 3; ++c)
        material.emission[c] = bounded(source.emissiveFactor[static_cast<size_t>(c)] * strength, 0.0,
                                       std::numeric_limits<float>::max()); // limitMaterial has a closer bound
    if (material.emission != glm::vec3(0.0f)) material.emissionTexture = reference(source.emissiveTexture);
    material.metallic = bounded(pbr.metallicFactor, 0.0, 1.0);
    material.roughness = bounded(pbr.roughnessFactor, 0.0, 1.0);
    material.metallicRoughnessTexture = reference(pbr.metallicRoughnessTexture);
    if (source.alphaMode == "MASK") material.alphaMode = AlphaMode::Mask;
    if (source.alphaMode == "BLEND") material.alphaMode = AlphaMode::Blend;
    material.alphaCutoff =
        bounded(source.alphaCutoff, 0.0, 2.0); // above 1: nothing is left, which glTF allows
    material.doubleSided = source.doubleSided;
    return material;
}

} // namespace

double numberOr(const tinygltf::Value& value, const char* key, double fallback) {
    if (!value.IsObject() || !value.Has(key) || !value.Get(key).IsNumber()) return fallback;
    return value.Get(key).GetNumberAsDouble();
}

void buildMaterials(Build& build) {
    MaterialBuilder builder(build);
    for (size_t i = 0; i < build.model.materials.size(); ++i) {
        build.scene.materials.push_back(builder.material(build.model.materials[i]));
        for (const std::string& problem : limitMaterial(build.scene.materials.back()))
            build.warnings.add(nameOf("material", build.model.materials[i].name, i), problem);
        if (build.scene.materials.back().alphaMode == AlphaMode::Blend)
            build.warnings.add(nameOf("material", build.model.materials[i].name, i),
                               "alpha mode BLEND is baked as opaque");
    }
}

} // namespace relume::gltf
