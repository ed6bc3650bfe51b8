#include "assets/gltf/gltf_material_json.h"

#include "assets/base/error.h"
#include "assets/gltf/file/gltf_value.h"
#include "assets/gltf/gltf_light_json.h"

#include <algorithm>
#include <cmath>

namespace relume::gltf {
namespace {

using Json = nlohmann::ordered_json;

// These values are those of the glTF 2.0 specification.
constexpr int kNearestFilter = 9728, kLinearFilter = 9729, kMipmapFilter = 9987;

int wrapCode(Wrap wrap) {
    switch (wrap) {
    case Wrap::MirroredRepeat:
        return 33648;
    case Wrap::ClampToEdge:
        return 33071;
    case Wrap::Repeat:
        break;
    }
    return 10497;
}

Json textureInfo(const TextureRef& ref, const std::string& materialName, UsedExtensions& used) {
    Json info;
    info["index"] = ref.texture;
    if (ref.texCoord != 0) info["texCoord"] = ref.texCoord;
    if (ref.transform == glm::mat3(1.0f)) return info;

    // The transform is translation * rotation * scale with rotation columns (c, -s), (s, c):
    // counter-clockwise in an image whose v points down.
    const glm::vec2 columnU(ref.transform[0]), columnV(ref.transform[1]);
    float scaleU = glm::length(columnU);
    float scaleV = glm::length(columnV);
    if (std::abs(glm::dot(columnU, columnV)) > 1e-4f * scaleU * scaleV)
        throw Error("material '" + materialName +
                    "': glTF cannot store a sheared texture transform: remove the shear");
    if (columnU.x * columnV.y - columnU.y * columnV.x < 0.0f) scaleV = -scaleV;
    const float rotation = scaleU > 0.0f ? std::atan2(-columnU.y, columnU.x) : 0.0f;
    Json transform;
    transform["offset"] = jsonArray(glm::vec2(ref.transform[2]));
    if (rotation != 0.0f) transform["rotation"] = rotation;
    transform["scale"] = jsonArray(glm::vec2(scaleU, scaleV));
    info["extensions"]["KHR_texture_transform"] = std::move(transform);
    used["KHR_texture_transform"] = true;
    return info;
}

void addKeptMap(Json& material, const char* key, const char* amount, const KeptMap& map,
                std::span<const int> kept, UsedExtensions& used) {
    if (map.use.texture < 0) return;
    TextureRef use = map.use;
    use.texture = kept[static_cast<size_t>(use.texture)];
    material[key] = textureInfo(use, material.value("name", ""), used);
    if (map.amount != 1.0f) material[key][amount] = map.amount;
}

} // namespace

nlohmann::ordered_json materialJson(const Material& m, std::span<const int> kept, UsedExtensions& used) {
    Json out;
    if (!m.name.empty()) out["name"] = m.name;
    Json pbr = Json::object();
    if (m.baseColor != glm::vec4(1.0f)) pbr["baseColorFactor"] = jsonArray(m.baseColor);
    if (m.baseColorTexture.texture >= 0)
        pbr["baseColorTexture"] = textureInfo(m.baseColorTexture, m.name, used);
    if (m.metallic != 1.0f) pbr["metallicFactor"] = m.metallic;
    if (m.roughness != 1.0f) pbr["roughnessFactor"] = m.roughness;
    if (m.metallicRoughnessTexture.texture >= 0)
        pbr["metallicRoughnessTexture"] = textureInfo(m.metallicRoughnessTexture, m.name, used);
    out["pbrMetallicRoughness"] = std::move(pbr);
    addKeptMap(out, "normalTexture", "scale", m.normalMap, kept, used);
    addKeptMap(out, "occlusionTexture", "strength", m.occlusionMap, kept, used);

    const float brightest = std::max({m.emission.r, m.emission.g, m.emission.b});
    if (brightest > 0.0f) {
        // The strength is a power of two, so that factor times strength is the emission again, to the last
        // bit.
        int exponent = 0;
        std::frexp(brightest, &exponent);
        const float strength = brightest > 1.0f ? std::ldexp(1.0f, exponent) : 1.0f;
        out["emissiveFactor"] = jsonArray(m.emission / strength);
        if (strength != 1.0f) {
            out["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] = strength;
            used["KHR_materials_emissive_strength"] = true;
        }
    }
    if (m.transmission > 0.0f) {
        out["extensions"]["KHR_materials_transmission"]["transmissionFactor"] = m.transmission;
        used["KHR_materials_transmission"] = true;
    }
    if (m.emissionTexture.texture >= 0) out["emissiveTexture"] = textureInfo(m.emissionTexture, m.name, used);
    if (m.alphaMode == AlphaMode::Mask) {
        out["alphaMode"] = "MASK";
        out["alphaCutoff"] = m.alphaCutoff;
    } else if (m.alphaMode == AlphaMode::Blend) {
        out["alphaMode"] = "BLEND";
    }
    if (m.doubleSided) out["doubleSided"] = true;
    return out;
}

void addLook(Json& json, const GlbLook& look, size_t material, UsedExtensions& used) {
    if (look.matte) {
        json["extensions"]["KHR_materials_specular"]["specularFactor"] = 0.0f;
        used["KHR_materials_specular"] = true;
    }
    if (look.lightmaps.empty() || material >= look.lit.size() || !look.lit[material]) return;
    const uint32_t page = look.page.empty() ? 0 : look.page[material];
    if (look.lightmaps.size() > 1) json["extras"]["relume"]["page"] = page;
    Json& lightmap = json["extensions"]["MOZ_lightmap"];
    lightmap["index"] = look.lightmaps[page];
    lightmap["texCoord"] = 1;
    lightmap["intensity"] = look.intensity;
    used["MOZ_lightmap"] = true;
}

Json samplerJson(const Texture& texture, bool mipmaps) {
    Json sampler;
    sampler["magFilter"] = texture.nearest ? kNearestFilter : kLinearFilter;
    sampler["minFilter"] = texture.nearest ? kNearestFilter : mipmaps ? kMipmapFilter : kLinearFilter;
    sampler["wrapS"] = wrapCode(texture.wrapS);
    sampler["wrapT"] = wrapCode(texture.wrapT);
    return sampler;
}

} // namespace relume::gltf
