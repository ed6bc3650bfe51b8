#include "bake/surface/alpha_tables.h"

#include "assets/base/error.h"
#include "assets/base/warnings.h"

#include <string>
#include <unordered_map>

namespace relume {
namespace {

constexpr uint32_t kNoTexels = 0xffffffffu; // AlphaMaterial::texels of a material without a texture

// Puts the alpha of images side by side.
class AlphaTexels {
public:
    AlphaTexels(const Scene& scene, std::vector<uint8_t>& texels, uint64_t most)
        : scene_(scene), texels_(texels), most_(most) {}

    /// Returns where an image's alpha begins.
    uint32_t of(int index) {
        const auto [it, isNew] = offsets_.try_emplace(index, static_cast<uint32_t>(texels_.size()));
        if (isNew) add(scene_.images[static_cast<size_t>(index)]);
        return it->second;
    }

private:
    void add(const Image& image) {
        const uint64_t own = uint64_t{image.width} * image.height;
        if (own > most_ || texels_.size() > most_ - own)
            throw Error(scene_.path + ": image " + inQuotes(image.name) +
                        ": the textures of masked materials have more than " + std::to_string(most_) +
                        " texels, which is all that masks have room for: make them smaller, or make "
                        "materials without holes opaque");
        texels_.reserve(texels_.size() + own);
        for (size_t i = 3; i < image.rgba.size(); i += 4)
            texels_.push_back(image.rgba[i]);
    }

    const Scene& scene_;
    std::vector<uint8_t>& texels_;
    const uint64_t most_; // [bytes]
    std::unordered_map<int, uint32_t> offsets_;
};

} // namespace

shader::AlphaTriangle alphaTriangle(const WorldMesh& mesh, uint32_t triangle, uint32_t material) {
    const glm::vec2* uv = &mesh.baseUv[size_t{triangle} * 3];
    const glm::vec4* c = &mesh.colors[size_t{triangle} * 3];
    return {uv[0], uv[1], uv[2], c[0].a, c[1].a, c[2].a, material};
}

int alphaImage(const Scene& scene, const Material& material) {
    const int texture = material.baseColorTexture.texture;
    return texture < 0 ? -1 : scene.textures[static_cast<size_t>(texture)].image;
}

shader::AlphaMaterial alphaMaterial(const Scene& scene, const Material& material, uint32_t texels) {
    shader::AlphaMaterial result{material.baseColor.a, material.alphaCutoff, kNoTexels, 0, 0, 0, 0};
    const int index = alphaImage(scene, material);
    if (index < 0) return result;
    const Texture& texture = scene.textures[static_cast<size_t>(material.baseColorTexture.texture)];
    const Image& image = scene.images[static_cast<size_t>(index)];
    result.texels = texels;
    result.width = image.width;
    result.height = image.height;
    result.wrapS = static_cast<uint32_t>(texture.wrapS);
    result.wrapT = static_cast<uint32_t>(texture.wrapT);
    return result;
}

void addAlphaTables(const Scene& scene, TraceScene& traced, uint64_t most) {
    const WorldMesh& m = traced.mesh;
    AlphaTexels texels(scene, traced.alphaTexels, most);
    std::unordered_map<uint32_t, uint32_t> numbers; // of materials
    for (uint32_t t = m.opaqueCount; t < m.triangleCount(); ++t) {
        const auto [it, isNew] =
            numbers.try_emplace(m.material[t], static_cast<uint32_t>(traced.alphaMaterials.size()));
        if (isNew) {
            const Material& material = scene.materials[m.material[t]]; // the default one has no holes
            const int image = alphaImage(scene, material);
            traced.alphaMaterials.push_back(alphaMaterial(scene, material, image < 0 ? 0 : texels.of(image)));
        }
        traced.alphaTriangles.push_back(alphaTriangle(m, t, it->second));
    }
}

} // namespace relume
