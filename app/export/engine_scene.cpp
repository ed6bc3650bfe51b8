#include "app/export/engine_scene.h"

#include "app/export/engine_metals.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <set>
#include <string>

#include <fmt/format.h>

namespace relume {
namespace {

// Says how primitives use a material of the file: each way makes a material of its own.
struct MaterialUse {
    size_t original = 0;
    bool mapped = false; // it has lightmap UVs
    int moved = -1;      // the set that its textures read for TEXCOORD_1 (Primitive::movedUvs)
    uint32_t page = 0;   // of the lightmap
    std::array<float, 3> tint = {1, 1, 1}; // of the light that it gets as emission

    auto operator<=>(const MaterialUse&) const = default;
};

// Tells whether a texture of the material, whose UVs moved already, reads TEXCOORD_1 or a set behind it,
// which needs the one before.
bool readsSecondSet(const Material& material) {
    const auto uses = textureUses(material);
    return std::any_of(uses.begin(), uses.end(),
                       [](const TextureRef* use) { return use->texture >= 0 && use->texCoord >= 1; });
}

// Returns the mean of a primitive's COLOR_0 over its area, with which emission is not multiplied in glTF.
std::array<float, 3> meanColor(const Primitive& primitive) {
    if (primitive.colors.empty()) return {1, 1, 1};
    glm::dvec3 sum(0.0);
    double area = 0;
    for (size_t i = 0; i + 2 < primitive.indices.size(); i += 3) {
        const uint32_t* t = &primitive.indices[i];
        const glm::dvec3 a(primitive.positions[t[0]]), b(primitive.positions[t[1]]),
            c(primitive.positions[t[2]]);
        const double weight = glm::length(glm::cross(b - a, c - a));
        for (int k = 0; k < 3; ++k)
            sum += weight / 3 * glm::dvec3(primitive.colors[t[k]]);
        area += weight;
    }
    if (area <= 0) return {1, 1, 1};
    const glm::vec3 mean(sum / area);
    return {mean.r, mean.g, mean.b};
}

// Returns how much the viewer shows of a pane that transmits (shaders/gl/scene.frag).
float shownOf(const Material& pane) {
    constexpr float kLeast = 0.08f; // of one that lets all pass
    return std::clamp(1.0f - pane.transmission, kLeast, 1.0f);
}

class MaterialSplit {
public:
    MaterialSplit(const Scene& scene, const glm::vec3& ambient)
        : originals_(scene.materials), ambient_(ambient) {
        originals_.emplace_back().name = "Default"; // glTF's default material
    }

    /// Returns the number in materials() of what a primitive is made of.
    int numberOf(const Primitive& primitive, bool mapped, uint32_t page) {
        const size_t original =
            primitive.material < 0 ? originals_.size() - 1 : static_cast<size_t>(primitive.material);
        MaterialUse use{original, mapped, primitive.movedUvs, mapped ? page : 0};
        if (!mapped || originals_[original].pane) use.tint = meanColor(primitive);
        const auto [place, isNew] = numbers_.try_emplace(use, static_cast<int>(materials_.size()));
        if (isNew) add(use);
        return place->second;
    }
    std::vector<Material>& materials() { return materials_; }
    std::vector<bool>& lit() { return lit_; }
    std::vector<uint32_t>& pages() { return pages_; }

private:
    void add(const MaterialUse& use) {
        Material material = originals_[use.original];
        material.occlusionMap = {}; // the lightmap has it, and engines would darken that by it once more
        for (TextureRef* texture : textureUses(material))
            texture->texCoord = setOf(use.moved, *texture);
        if (!use.mapped || material.pane)
            material = shining(material, {use.tint[0], use.tint[1], use.tint[2]});
        // Engines find materials by name, and some have the name in a line of their code.
        std::replace_if(
            material.name.begin(), material.name.end(), [](unsigned char c) { return c < ' '; }, ' ');
        if (material.name.empty()) material.name = fmt::format("Material {}", use.original);
        const std::string name = material.name;
        for (int number = 2; !names_.insert(material.name).second; ++number)
            material.name = fmt::format("{} ({})", name, number);
        lit_.push_back(use.mapped && !material.pane);
        pages_.push_back(use.page);
        materials_.push_back(std::move(material));
    }
    Material shining(Material material, const glm::vec3& tint) const {
        const float albedo = 1.0f - engineMetallic(material.metallic, material.roughness);
        // Engines add emission to what a pane transmits, whatever its share.
        const float shown = material.pane && material.transmission > 0.0f ? shownOf(material) : 1.0f;
        if (material.emission == glm::vec3(0.0f)) {
            material.emission = glm::vec3(material.baseColor) * tint * (shown * albedo) * ambient_;
            material.emissionTexture = material.baseColorTexture;
        }
        return material;
    }

    std::vector<Material> originals_, materials_;
    std::vector<bool> lit_;
    std::vector<uint32_t> pages_;
    glm::vec3 ambient_;
    std::map<MaterialUse, int> numbers_;
    std::set<std::string> names_;
};

} // namespace

EngineScene engineScene(const Scene& scene, const LightmapAtlas& atlas, const glm::vec3& ambient) {
    EngineScene out;
    Scene placed = withAtlas(scene, atlas);
    MaterialSplit split(scene, ambient);
    for (size_t i = 0; i < placed.instances.size(); ++i) {
        Instance instance = placed.instances[i];
        if (instance.hidden || instance.mesh < 0) continue;
        Mesh mesh = placed.meshes[static_cast<size_t>(instance.mesh)];
        mesh.batched = false;
        if (!instance.name.empty()) mesh.name = instance.name;
        for (Primitive& primitive : mesh.primitives) {
            const bool mapped = atlas.instances[i].texCoord >= 0 && !primitive.texCoord1.empty();
            const int number = split.numberOf(primitive, mapped, instance.page);
            // Some engines light whatever has a second set of UVs.
            if (!split.lit()[static_cast<size_t>(number)] &&
                !readsSecondSet(split.materials()[static_cast<size_t>(number)]))
                primitive.texCoord1.clear();
            primitive.material = number;
            primitive.movedUvs = -1;
        }
        instance.mesh = static_cast<int>(out.scene.meshes.size());
        instance.density = 1.0f;
        out.scene.instances.push_back(std::move(instance));
        out.scene.meshes.push_back(std::move(mesh));
    }
    out.scene.path = scene.path;
    out.scene.images = std::move(placed.images);
    out.scene.textures = std::move(placed.textures);
    out.scene.keptTextures = std::move(placed.keptTextures);
    out.scene.cameras = std::move(placed.cameras);
    out.scene.materials = std::move(split.materials());
    out.lit = std::move(split.lit());
    out.page = std::move(split.pages());
    out.scene.pages = placed.pages;
    giveEngineMetals(out.scene);
    dropUnusedTextures(out.scene);
    return out;
}

void blendWhatTransmits(Scene& scene) {
    for (Material& material : scene.materials) {
        if (!material.pane || material.transmission <= 0.0f) continue;
        const float shown = shownOf(material);
        material.emission /= shown; // as blending multiplies it by the alpha
        material.baseColor.a = shown * (material.alphaMode == AlphaMode::Blend ? material.baseColor.a : 1.0f);
        material.alphaMode = AlphaMode::Blend;
        material.transmission = 0.0f;
    }
}

namespace {

// Returns the transform through which all of a material's textures read TEXCOORD_0; nothing where they have
// several.
std::optional<glm::mat3> commonTransform(const Material& material) {
    std::optional<glm::mat3> common;
    for (const TextureRef* use : textureUses(material)) {
        if (use->texture < 0 || use->texCoord != 0) continue;
        if (common && *common != use->transform) return std::nullopt;
        common = use->transform;
    }
    return common.value_or(glm::mat3(1.0f));
}

} // namespace

std::vector<std::string> applyTextureTransforms(Scene& scene) {
    std::vector<std::string> several;
    std::vector<glm::mat3> transforms; // by material
    for (Material& material : scene.materials) {
        const std::optional<glm::mat3> common = commonTransform(material);
        transforms.push_back(common.value_or(glm::mat3(1.0f)));
        if (!common) {
            several.push_back(material.name);
            continue;
        }
        for (TextureRef* use : textureUses(material))
            if (use->texCoord == 0) use->transform = glm::mat3(1.0f);
    }
    for (Mesh& mesh : scene.meshes) {
        for (Primitive& primitive : mesh.primitives) {
            const glm::mat3& transform = transforms[static_cast<size_t>(primitive.material)];
            if (transform == glm::mat3(1.0f)) continue;
            for (glm::vec2& uv : primitive.texCoord0)
                uv = glm::vec2(transform * glm::vec3(uv, 1.0f));
        }
    }
    return several;
}

std::vector<std::string> meshesWithThirdSet(const Scene& scene) {
    std::vector<std::string> names;
    for (const Mesh& mesh : scene.meshes)
        if (std::any_of(mesh.primitives.begin(), mesh.primitives.end(), [&](const Primitive& primitive) {
                if (primitive.material < 0) return false;
                const auto uses = textureUses(scene.materials[static_cast<size_t>(primitive.material)]);
                return std::any_of(uses.begin(), uses.end(), [&](const TextureRef* use) {
                    return use->texture >= 0 && setOf(primitive.movedUvs, *use) == 2;
                });
            }))
            names.push_back(mesh.name);
    std::sort(names.begin(), names.end());
    names.erase(std::unique(names.begin(), names.end()), names.end());
    return names;
}

namespace {

// Makes the number of a used thing, or -1, that which it has among the used ones, where it goes.
template<typename T>
void renumber(int& number, std::vector<T>& all, std::map<int, int>& numbers, std::vector<T>& used) {
    if (number < 0) return;
    const auto [place, isNew] = numbers.try_emplace(number, static_cast<int>(used.size()));
    if (isNew) used.push_back(std::move(all[static_cast<size_t>(number)]));
    number = place->second;
}

} // namespace

void dropUnusedTextures(Scene& scene) {
    std::map<int, int> textures, kept, images; // from old numbers to new ones
    std::vector<Texture> usedTextures;
    std::vector<KeptTexture> usedKept;
    std::vector<Image> usedImages;
    for (Material& material : scene.materials) {
        for (KeptMap* map : {&material.normalMap, &material.occlusionMap})
            renumber(map->use.texture, scene.keptTextures, kept, usedKept);
        for (TextureRef* use :
             {&material.baseColorTexture, &material.emissionTexture, &material.metallicRoughnessTexture})
            renumber(use->texture, scene.textures, textures, usedTextures);
    }
    for (KeptTexture& texture : usedKept)
        renumber(texture.texture, scene.textures, textures, usedTextures);
    for (Texture& texture : usedTextures)
        renumber(texture.image, scene.images, images, usedImages);
    scene.textures = std::move(usedTextures);
    scene.keptTextures = std::move(usedKept);
    scene.images = std::move(usedImages);
}

} // namespace relume
