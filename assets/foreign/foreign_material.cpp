#include "assets/foreign/foreign_build.h"
#include "assets/foreign/foreign_picture.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <optional>
#include <tuple>

namespace relume::foreign {
namespace {

/// A material's use of a picture.
struct Use {
    std::string reference;
    aiTextureType type = aiTextureType_NONE;
    Wrap wrapS = Wrap::Repeat, wrapT = Wrap::Repeat;
};

Wrap wrapOf(int mode) {
    switch (mode) {
    case aiTextureMapMode_Clamp:
    case aiTextureMapMode_Decal:
        return Wrap::ClampToEdge;
    case aiTextureMapMode_Mirror:
        return Wrap::MirroredRepeat;
    default:
        return Wrap::Repeat;
    }
}

/// Returns the first picture of these types that a material has.
std::optional<Use> useOf(const aiMaterial& source, std::initializer_list<aiTextureType> types) {
    for (const aiTextureType type : types) {
        aiString file;
        if (source.Get(AI_MATKEY_TEXTURE(type, 0), file) != aiReturn_SUCCESS || file.length == 0) continue;
        Use use{.reference = std::string(file.data, file.length), .type = type};
        int mode = aiTextureMapMode_Wrap;
        source.Get(AI_MATKEY_MAPPINGMODE_U(type, 0), mode);
        use.wrapS = wrapOf(mode);
        mode = aiTextureMapMode_Wrap;
        source.Get(AI_MATKEY_MAPPINGMODE_V(type, 0), mode);
        use.wrapT = wrapOf(mode);
        return use;
    }
    return {};
}

float finiteOr(float value, float fallback) {
    return std::isfinite(value) ? value : fallback;
}

glm::vec3 rgbOf(const aiColor4D& color) {
    return {std::max(finiteOr(color.r, 0.0f), 0.0f), std::max(finiteOr(color.g, 0.0f), 0.0f),
            std::max(finiteOr(color.b, 0.0f), 0.0f)};
}

class MaterialBuilder {
public:
    explicit MaterialBuilder(Build& build) : build_(build), pictures_(build) {}
    Material make(const aiMaterial& source);

private:
    int texture(int image, const Use& use);
    void setBaseColor(const aiMaterial& source, Material& material);
    void setEmission(const aiMaterial& source, Material& material);
    float opacityOf(const aiMaterial& source, const Material& material);

    Build& build_;
    Pictures pictures_;
    std::map<std::tuple<int, Wrap, Wrap>, int> textures_;
};

int MaterialBuilder::texture(int image, const Use& use) {
    if (image < 0) return -1;
    std::vector<Texture>& textures = build_.made.scene.textures;
    const auto [known, isNew] =
        textures_.try_emplace({image, use.wrapS, use.wrapT}, static_cast<int>(textures.size()));
    if (isNew) textures.push_back({.image = image, .wrapS = use.wrapS, .wrapT = use.wrapT});
    return known->second;
}

// Many exporters write the share that is let through where the opacity belongs: what could not be seen at all
// would not be in the file.
float MaterialBuilder::opacityOf(const aiMaterial& source, const Material& material) {
    float opacity = 1.0f;
    source.Get(AI_MATKEY_OPACITY, opacity);
    opacity = std::clamp(finiteOr(opacity, 1.0f), 0.0f, 1.0f);
    if (opacity > 0.0f) return opacity;
    build_.warnings.add("material " + inQuotes(material.name), "has the opacity 0, taken as opaque");
    return 1.0f;
}

void MaterialBuilder::setBaseColor(const aiMaterial& source, Material& material) {
    aiColor4D color(1.0f, 1.0f, 1.0f, 1.0f);
    if (source.Get(AI_MATKEY_BASE_COLOR, color) != aiReturn_SUCCESS)
        source.Get(AI_MATKEY_COLOR_DIFFUSE, color);
    glm::vec3 rgb = glm::min(rgbOf(color), glm::vec3(1.0f));
    float opacity = opacityOf(source, material);
    const auto use = useOf(source, {aiTextureType_BASE_COLOR, aiTextureType_DIFFUSE});
    if (use) {
        const auto mask = useOf(source, {aiTextureType_OPACITY});
        const Pictures::Masked found =
            mask ? pictures_.imageWithAlpha(use->reference, mask->reference, material.name)
                 : Pictures::Masked{pictures_.image(use->reference, material.name)};
        material.baseColorTexture.texture = texture(found.image, *use);
        if (found.masked) {
            material.alphaMode = AlphaMode::Mask;
            opacity = 1.0f;
        }
    }
    // The picture takes the colour's place, but in .obj files, where they are multiplied.
    const bool multiplied = build_.ending == ".obj" && rgb != glm::vec3(0.0f);
    if (material.baseColorTexture.texture >= 0 && !multiplied) rgb = glm::vec3(1.0f);
    if (opacity < 1.0f) material.alphaMode = AlphaMode::Blend;
    material.baseColor = glm::vec4(rgb, opacity);
}

void MaterialBuilder::setEmission(const aiMaterial& source, Material& material) {
    aiColor4D color(0.0f, 0.0f, 0.0f, 1.0f);
    source.Get(AI_MATKEY_COLOR_EMISSIVE, color);
    float strength = 1.0f;
    source.Get(AI_MATKEY_EMISSIVE_INTENSITY, strength);
    material.emission = rgbOf(color) * std::max(finiteOr(strength, 1.0f), 0.0f) * unitOfLight(build_);
    const auto use = useOf(source, {aiTextureType_EMISSION_COLOR, aiTextureType_EMISSIVE});
    if (!use) return;
    material.emissionTexture.texture = texture(pictures_.image(use->reference, material.name), *use);
    if (material.emissionTexture.texture >= 0 && material.emission == glm::vec3(0.0f))
        material.emission = glm::vec3(unitOfLight(build_));
}

Material MaterialBuilder::make(const aiMaterial& source) {
    Material material;
    aiString name;
    if (source.Get(AI_MATKEY_NAME, name) == aiReturn_SUCCESS) material.name = nameOf(name);
    material.metallic = 0.0f;
    source.Get(AI_MATKEY_METALLIC_FACTOR, material.metallic);
    material.metallic = std::clamp(finiteOr(material.metallic, 0.0f), 0.0f, 1.0f);
    source.Get(AI_MATKEY_ROUGHNESS_FACTOR, material.roughness);
    material.roughness = std::clamp(finiteOr(material.roughness, 1.0f), 0.0f, 1.0f);
    int twoSided = 0;
    source.Get(AI_MATKEY_TWOSIDED, twoSided);
    material.doubleSided = twoSided != 0;
    setBaseColor(source, material);
    setEmission(source, material);
    return material;
}

} // namespace

void buildMaterials(Build& build) {
    MaterialBuilder builder(build);
    std::vector<bool> used(build.source->mNumMaterials, false);
    for (unsigned i = 0; i < build.source->mNumMeshes; ++i)
        if (const unsigned material = build.source->mMeshes[i]->mMaterialIndex; material < used.size())
            used[material] = true;
    std::vector<Material>& materials = build.made.scene.materials;
    for (unsigned i = 0; i < build.source->mNumMaterials; ++i) {
        build.materials.push_back(used[i] ? static_cast<int>(materials.size()) : -1);
        if (used[i]) materials.push_back(builder.make(*build.source->mMaterials[i]));
    }
}

} // namespace relume::foreign
