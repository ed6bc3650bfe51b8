#include "assets/gltf/gltf_build.h"
#include "assets/gltf/gltf_kept.h"

#include "assets/base/watch.h"
#include "assets/gltf/file/gltf_value.h"
#include "assets/model/panes.h"
#include "assets/model/scene_limits.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace relume::gltf {

namespace {

using nlohmann::json;

constexpr const char* kBasisu = "KHR_texture_basisu";

/// Builds materials and, on first use, the textures and images they name.
class MaterialBuilder {
public:
    explicit MaterialBuilder(Build& build)
        : build_(build), textureIndex_(build.textures.size(), kNotUsed),
          imageIndex_(build.images.size(), kNotUsed), keptIndex_(build.textures.size(), kNotUsed) {}
    Material material(const json& source, const std::string& where);
    /// Adds what is kept of a material for files that are written. It comes behind all materials: what one of
    /// them reads is not kept twice.
    void addKept(const json& source, Material& material);

private:
    static constexpr int kNotUsed = -1, kUnusable = -2;

    TextureRef reference(const json& holder, const char* key);
    TextureRef use(const json& info, int texture);
    KeptMap keptMap(const json& holder, const char* key, const char* amount);
    int keptTexture(size_t source);
    bool readKept(size_t source, KeptTexture& texture);
    void readSampler(const json& texture, Texture& to) const;
    int texture(size_t source);
    int image(size_t source);
    std::vector<size_t> imagesOf(const json& texture) const;
    void warnAboutTexture(const json& texture, size_t index);
    void readBase(const json& source, const std::string& where, Material& material);
    void readEmission(const json& source, Material& material);
    double meanRed(const json& holder, const char* key);
    double transmissionOf(const json& source, const Material& material);

    Build& build_;
    // These lead from the file's numbers to the scene's, or to one of the constants above.
    std::vector<int> textureIndex_, imageIndex_, keptIndex_;
};

std::string materialLabel(const json& material, size_t index) {
    const std::string name = material.value("name", "");
    return name.empty() ? fmt::format("material {}", index) : "material " + inQuotes(name);
}

// These values are those of the glTF 2.0 specification.
constexpr int kClampToEdge = 33071, kMirroredRepeat = 33648, kNearest = 9728;

Wrap wrapOf(const json& sampler, const char* key) {
    const double value = numberOr(sampler, key, 0.0);
    if (value == kClampToEdge) return Wrap::ClampToEdge;
    return value == kMirroredRepeat ? Wrap::MirroredRepeat : Wrap::Repeat;
}

/// Returns as many numbers of an array as there are, or nothing where it has others.
template<typename Vec>
std::optional<Vec> vectorOf(const json& holder, const char* key) {
    const json* array = memberOf(holder, key);
    if (!array || !array->is_array() || array->size() != static_cast<size_t>(Vec::length()))
        return std::nullopt;
    Vec out;
    for (glm::length_t i = 0; i < Vec::length(); ++i) {
        const json& value = (*array)[static_cast<size_t>(i)];
        if (!value.is_number()) return std::nullopt;
        out[i] = value.get<double>();
    }
    return out;
}

/// Returns the matrix of KHR_texture_transform: translation * rotation * scale, the rotation
/// counter-clockwise with v pointing down.
glm::mat3 transformMatrix(const json& extension) {
    const glm::vec2 offset = vectorOf<glm::dvec2>(extension, "offset").value_or(glm::dvec2(0.0));
    const glm::vec2 scale = vectorOf<glm::dvec2>(extension, "scale").value_or(glm::dvec2(1.0));
    const double angle = numberOr(extension, "rotation", 0.0);
    const float c = static_cast<float>(std::cos(angle)), s = static_cast<float>(std::sin(angle));
    const glm::mat3 rotation(c, -s, 0.0f, s, c, 0.0f, 0.0f, 0.0f, 1.0f);
    glm::mat3 translation(1.0f), scaling(1.0f);
    translation[2] = glm::vec3(offset, 1.0f);
    scaling[0][0] = scale.x;
    scaling[1][1] = scale.y;
    return translation * rotation * scaling;
}

float bounded(double value, double low, double high) {
    return std::isfinite(value) ? static_cast<float>(std::clamp(value, low, high)) : static_cast<float>(low);
}

glm::vec4 factorOf(const json& holder, const char* key) {
    const glm::dvec4 factor = vectorOf<glm::dvec4>(holder, key).value_or(glm::dvec4(1.0));
    glm::vec4 out;
    for (int c = 0; c < 4; ++c)
        out[c] = bounded(factor[c], 0.0, 1.0);
    return out;
}

int MaterialBuilder::image(size_t source) {
    int& known = imageIndex_[source];
    if (known != kNotUsed) return known;
    tellWatch("loading");
    std::optional<Image> decoded = decodeImage(build_, source);
    if (!decoded) return known = kUnusable;
    build_.scene.images.push_back(std::move(*decoded));
    return known = static_cast<int>(build_.scene.images.size()) - 1;
}

/// Returns the images that a texture may be read from, the one to be preferred first. A KTX2 picture of
/// KHR_texture_basisu is none of them, since no decoder for it is packaged anywhere.
std::vector<size_t> MaterialBuilder::imagesOf(const json& texture) const {
    std::vector<size_t> images;
    const auto add = [&](const json& holder) {
        const int index = indexBelow(holder, "source", build_.images.size());
        if (index >= 0) images.push_back(static_cast<size_t>(index));
    };
    if (const json* webp = extensionOf(texture, "EXT_texture_webp")) add(*webp);
    add(texture);
    return images;
}

void MaterialBuilder::warnAboutTexture(const json& texture, size_t index) {
    build_.warnings.add(fmt::format("texture {}", index),
                        extensionOf(texture, kBasisu)
                            ? "has only a KTX2 image, which cannot be decoded, materials use their factors "
                              "alone: export textures as PNG, JPEG or WebP"
                            : "has no PNG, JPEG or WebP image, materials use their factors alone: export "
                              "textures as one of these");
}

void MaterialBuilder::readSampler(const json& texture, Texture& to) const {
    const int sampler = indexBelow(texture, "sampler", build_.samplers.size());
    if (sampler < 0) return;
    const json& how = build_.samplers[static_cast<size_t>(sampler)];
    to.wrapS = wrapOf(how, "wrapS");
    to.wrapT = wrapOf(how, "wrapT");
    to.nearest = numberOr(how, "magFilter", 0.0) == kNearest;
}

int MaterialBuilder::texture(size_t source) {
    int& known = textureIndex_[source];
    if (known != kNotUsed) return known;
    const json& from = build_.textures[source];
    Texture texture;
    const std::vector<size_t> images = imagesOf(from);
    for (size_t i = 0; i < images.size() && texture.image < 0; ++i)
        texture.image = image(images[i]);
    if (images.empty()) warnAboutTexture(from, source);
    if (texture.image < 0) return known = kUnusable;
    readSampler(from, texture);
    build_.scene.textures.push_back(texture);
    return known = static_cast<int>(build_.scene.textures.size()) - 1;
}

/// Returns the use of a texture, or none where there is none or its image is unusable.
TextureRef MaterialBuilder::reference(const json& holder, const char* key) {
    TextureRef ref;
    const json* info = memberOf(holder, key);
    const int index = info ? indexBelow(*info, "index", build_.textures.size()) : -1;
    if (index < 0) return ref;
    return use(*info, std::max(texture(static_cast<size_t>(index)), -1));
}

TextureRef MaterialBuilder::use(const json& info, int texture) {
    TextureRef ref;
    ref.texture = texture;
    if (texture < 0) return ref;
    double texCoord = numberOr(info, "texCoord", 0.0);
    if (const json* extension = extensionOf(info, "KHR_texture_transform")) {
        ref.transform = transformMatrix(*extension);
        texCoord = numberOr(*extension, "texCoord", texCoord);
    }
    if (texCoord >= 3.0)
        build_.warnings.add(fmt::format("texture {}", numberOr(info, "index", 0.0)),
                            "uses TEXCOORD_3 or higher, TEXCOORD_0 is taken");
    ref.texCoord = texCoord == 1.0 ? 1 : texCoord == 2.0 ? 2 : 0;
    return ref;
}

/// Finds the picture of a kept texture. Returns false, and warns, where there is none that can be kept.
bool MaterialBuilder::readKept(size_t source, KeptTexture& texture) {
    std::vector<size_t> images = imagesOf(build_.textures[source]);
    std::reverse(images.begin(), images.end()); // what glTF itself knows is written as it is
    for (const size_t image : images)
        if (keepImage(build_, image, texture)) return true;
    build_.warnings.add(
        fmt::format("texture {}", source),
        "has no PNG, JPEG or WebP image that is there, and is left out of files that are written");
    return false;
}

int MaterialBuilder::keptTexture(size_t source) {
    int& known = keptIndex_[source];
    if (known != kNotUsed) return known;
    KeptTexture texture;
    texture.texture = std::max(textureIndex_[source], -1);
    if (texture.texture < 0) {
        readSampler(build_.textures[source], texture.sampling);
        if (textureIndex_[source] == kUnusable || !readKept(source, texture)) return known = kUnusable;
    }
    build_.scene.keptTextures.push_back(std::move(texture));
    return known = static_cast<int>(build_.scene.keptTextures.size()) - 1;
}

KeptMap MaterialBuilder::keptMap(const json& holder, const char* key, const char* amount) {
    KeptMap map;
    const json* info = memberOf(holder, key);
    const int index = info ? indexBelow(*info, "index", build_.textures.size()) : -1;
    if (index < 0) return map;
    map.use = use(*info, std::max(keptTexture(static_cast<size_t>(index)), -1));
    const double value = numberOr(*info, amount, 1.0);
    if (std::isfinite(value)) map.amount = static_cast<float>(value);
    return map;
}

void MaterialBuilder::addKept(const json& source, Material& material) {
    material.normalMap = keptMap(source, "normalTexture", "scale");
    material.occlusionMap = keptMap(source, "occlusionTexture", "strength");
}

/// Reads the base colour and the metalness: those of the core, of specular-glossiness, whose diffuse colour
/// is a base colour without metal, and of an unlit material, which is all base colour.
void MaterialBuilder::readBase(const json& source, const std::string& where, Material& material) {
    static const json kNone = json::object();
    const json* found = memberOf(source, "pbrMetallicRoughness");
    const json& pbr = found ? *found : kNone;
    const json* glossy = extensionOf(source, kSpecularGlossiness);
    const bool unlit = extensionOf(source, "KHR_materials_unlit") != nullptr;
    if (glossy && !unlit) {
        material.baseColor = factorOf(*glossy, "diffuseFactor");
        material.baseColorTexture = reference(*glossy, "diffuseTexture");
        material.metallic = 0.0f;
        // A texture says it texel by texel, and a factor of it means nothing alone.
        if (!memberOf(*glossy, "specularGlossinessTexture"))
            material.roughness = 1.0f - bounded(numberOr(*glossy, "glossinessFactor", 1.0), 0.0, 1.0);
        return;
    }
    material.baseColor = factorOf(pbr, "baseColorFactor");
    material.baseColorTexture = reference(pbr, "baseColorTexture");
    if (unlit) {
        material.metallic = 0.0f;
        build_.warnings.add(where, "KHR_materials_unlit is baked as a diffuse surface of its base colour");
        return;
    }
    material.metallic = bounded(numberOr(pbr, "metallicFactor", 1.0), 0.0, 1.0);
    material.roughness = bounded(numberOr(pbr, "roughnessFactor", 1.0), 0.0, 1.0);
    material.metallicRoughnessTexture = reference(pbr, "metallicRoughnessTexture");
}

void MaterialBuilder::readEmission(const json& source, Material& material) {
    double strength = 1.0;
    if (const json* extension = extensionOf(source, "KHR_materials_emissive_strength"))
        strength = numberOr(*extension, "emissiveStrength", 1.0);
    const glm::dvec3 factor = vectorOf<glm::dvec3>(source, "emissiveFactor").value_or(glm::dvec3(0.0));
    for (int c = 0; c < 3; ++c)
        material.emission[c] = bounded(factor[c] * strength, 0.0,
                                       std::numeric_limits<float>::max()); // limitMaterial has a closer bound
    if (material.emission != glm::vec3(0.0f)) material.emissionTexture = reference(source, "emissiveTexture");
}

/// Returns the mean of a texture's red channel, as the file has it, or 1 where there is none. The picture is
/// not kept, since nothing else of it is used.
double MaterialBuilder::meanRed(const json& holder, const char* key) {
    const json* info = memberOf(holder, key);
    const int index = info ? indexBelow(*info, "index", build_.textures.size()) : -1;
    if (index < 0) return 1.0;
    for (const size_t source : imagesOf(build_.textures[static_cast<size_t>(index)]))
        if (const std::optional<Image> image = decodeImage(build_, source)) return meanOfChannel(*image, 0);
    return 1.0;
}

/// Returns how much of its light a material of KHR_materials_transmission lets through: a metal lets none.
double MaterialBuilder::transmissionOf(const json& source, const Material& material) {
    const json* extension = extensionOf(source, "KHR_materials_transmission");
    if (!extension) return 0.0;
    if (material.metallic == 1.0f && material.metallicRoughnessTexture.texture < 0) return 0.0;
    const double transmission = bounded(numberOr(*extension, "transmissionFactor", 0.0), 0.0, 1.0);
    // Only where it matters is a picture decoded for it.
    return transmission > kLeastTransmission ? transmission * meanRed(*extension, "transmissionTexture")
                                             : transmission;
}

Material MaterialBuilder::material(const json& source, const std::string& where) {
    Material material;
    material.name = source.value("name", "");
    readBase(source, where, material);
    readEmission(source, material);
    material.transmission = static_cast<float>(transmissionOf(source, material));
    const std::string alphaMode = source.value("alphaMode", "");
    if (alphaMode == "MASK") material.alphaMode = AlphaMode::Mask;
    if (alphaMode == "BLEND") material.alphaMode = AlphaMode::Blend;
    material.alphaCutoff = bounded(numberOr(source, "alphaCutoff", 0.5), 0.0,
                                   2.0); // above 1: nothing is left, which glTF allows
    material.doubleSided = boolOr(source, "doubleSided", false);
    return material;
}

} // namespace

void buildMaterials(Build& build) {
    MaterialBuilder builder(build);
    for (size_t i = 0; i < build.materials.size(); ++i) {
        const std::string where = materialLabel(build.materials[i], i);
        build.scene.materials.push_back(builder.material(build.materials[i], where));
        for (const std::string& problem : limitMaterial(build.scene.materials.back()))
            build.warnings.add(where, problem);
    }
    for (size_t i = 0; i < build.materials.size(); ++i)
        builder.addKept(build.materials[i], build.scene.materials[i]);
}

void markPanes(Build& build) {
    relume::markPanes(build.scene);
    for (size_t i = 0; i < build.scene.materials.size(); ++i) {
        const Material& material = build.scene.materials[i];
        if (material.pane)
            build.warnings.add(materialLabel(build.materials[i], i),
                               "is seen through: light passes it as though it were not there");
        else if (material.alphaMode == AlphaMode::Blend)
            build.warnings.add(materialLabel(build.materials[i], i), "alpha mode BLEND is baked as opaque");
    }
}

} // namespace relume::gltf
