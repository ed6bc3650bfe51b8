#include "app/export/engine_scene.h"

#include "app/export/engine_metals.h"

#include <algorithm>
#include <array>
#include <map>
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

    auto operator<=>(const MaterialUse&) const = default;
};

std::array<TextureRef*, 3> usesOf(Material& material) {
    return {&material.baseColorTexture, &material.emissionTexture, &material.metallicRoughnessTexture};
}

// Tells whether a texture of the material, whose UVs moved already, reads TEXCOORD_1 or a set behind it,
// which needs the one before.
bool readsSecondSet(Material material) {
    const auto uses = usesOf(material);
    return std::any_of(uses.begin(), uses.end(),
                       [](const TextureRef* use) { return use->texture >= 0 && use->texCoord >= 1; });
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
        const MaterialUse use{original, mapped, primitive.movedUvs, mapped ? page : 0};
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
        for (TextureRef* texture : usesOf(material))
            texture->texCoord = setOf(use.moved, *texture);
        if (!use.mapped || material.pane) material = shining(material);
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
    Material shining(Material material) const {
        const float albedo = 1.0f - engineMetallic(material.metallic, material.roughness);
        if (material.emission == glm::vec3(0.0f)) {
            material.emission = glm::vec3(material.baseColor) * albedo * ambient_;
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
    out.scene.cameras = std::move(placed.cameras);
    out.scene.materials = std::move(split.materials());
    out.lit = std::move(split.lit());
    out.page = std::move(split.pages());
    out.scene.pages = placed.pages;
    giveEngineMetals(out.scene);
    dropUnusedTextures(out.scene);
    return out;
}

std::vector<std::string> meshesWithThirdSet(const Scene& scene) {
    std::vector<std::string> names;
    for (const Mesh& mesh : scene.meshes)
        if (std::any_of(mesh.primitives.begin(), mesh.primitives.end(), [&](const Primitive& primitive) {
                if (primitive.material < 0) return false;
                Material material = scene.materials[static_cast<size_t>(primitive.material)];
                const auto uses = usesOf(material);
                return std::any_of(uses.begin(), uses.end(), [&](const TextureRef* use) {
                    return use->texture >= 0 && setOf(primitive.movedUvs, *use) == 2;
                });
            }))
            names.push_back(mesh.name);
    std::sort(names.begin(), names.end());
    names.erase(std::unique(names.begin(), names.end()), names.end());
    return names;
}

void dropUnusedTextures(Scene& scene) {
    std::map<int, int> textures, images; // from old numbers to new ones
    std::vector<Texture> usedTextures;
    std::vector<Image> usedImages;
    for (Material& material : scene.materials)
        for (TextureRef* use : usesOf(material)) {
            if (use->texture < 0) continue;
            const auto [place, isNew] =
                textures.try_emplace(use->texture, static_cast<int>(usedTextures.size()));
            if (isNew) usedTextures.push_back(scene.textures[static_cast<size_t>(use->texture)]);
            use->texture = place->second;
        }
    for (Texture& texture : usedTextures) {
        if (texture.image < 0) continue;
        const auto [place, isNew] = images.try_emplace(texture.image, static_cast<int>(usedImages.size()));
        if (isNew) usedImages.push_back(std::move(scene.images[static_cast<size_t>(texture.image)]));
        texture.image = place->second;
    }
    scene.textures = std::move(usedTextures);
    scene.images = std::move(usedImages);
}

} // namespace relume
