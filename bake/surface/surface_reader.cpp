#include "bake/surface/surface_reader.h"

#include "assets/images/float_image.h"
#include "bake/surface/alpha_tables.h"

namespace relume {
namespace shader {
namespace {

// Applies the tracers' alpha test to one image.
struct ImageAlpha {
    const Image* image;
    float alphaTexel(uint texel) const { return float(image->rgba[size_t{texel} * 4 + 3]) / 255.0f; }
#include "shaders/lib/rays/alpha.glsl"
};

} // namespace
} // namespace shader

namespace {

template<typename Value>
Value between(const std::vector<Value>& corners, uint32_t triangle, const glm::vec3& w) {
    const Value* c = &corners[size_t{triangle} * 3];
    return c[0] * w.x + c[1] * w.y + c[2] * w.z;
}

} // namespace

SurfaceReader::SurfaceReader(const Scene& scene, const WorldMesh& mesh)
    : scene_(scene), mesh_(mesh), materials_(scene.materials), masks_(scene.materials.size() + 1) {
    materials_.emplace_back(); // glTF's default material
    for (size_t i = 0; i < scene.materials.size(); ++i) {
        const int image = alphaImage(scene, materials_[i]);
        masks_[i] = {alphaMaterial(scene, materials_[i], 0),
                     image < 0 ? nullptr : &scene.images[static_cast<size_t>(image)]};
    }
    for (uint32_t i = 0; i < 256; ++i)
        linear_[i] = static_cast<float>(linearFromSrgb(static_cast<float>(i) / 255.0f));
}

glm::vec4 SurfaceReader::texelAt(const TextureRef& ref, const glm::vec2& uv, bool srgb) const {
    if (ref.texture < 0) return glm::vec4(1.0f);
    const Texture& texture = scene_.textures[static_cast<size_t>(ref.texture)];
    const Image& image = scene_.images[static_cast<size_t>(texture.image)];
    shader::ImageAlpha nearest{&image};
    const uint32_t x = nearest.wrapTexel(uv.x, image.width, static_cast<uint32_t>(texture.wrapS));
    const uint32_t y = nearest.wrapTexel(uv.y, image.height, static_cast<uint32_t>(texture.wrapT));
    const uint8_t* p = &image.rgba[(size_t{y} * image.width + x) * 4];
    const auto plain = [&](size_t k) { return static_cast<float>(p[k]) / 255.0f; };
    if (srgb) return {linear_[p[0]], linear_[p[1]], linear_[p[2]], plain(3)};
    return {plain(0), plain(1), plain(2), plain(3)};
}

SurfaceColour SurfaceReader::colourAt(uint32_t triangle, const glm::vec3& weights) const {
    const Material& material = materials_[mesh_.material[triangle]];
    const auto texel = [&](const TextureRef& ref, const std::vector<glm::vec2>& uvs, bool srgb) {
        return texelAt(ref, ref.texture < 0 ? glm::vec2(0.0f) : between(uvs, triangle, weights), srgb);
    };
    const glm::vec4 surface = texel(material.metallicRoughnessTexture, mesh_.metallicUv, false);
    const float metallic = material.metallic * surface.b, roughness = material.roughness * surface.g;
    // A rough metal still sends light on, as in shaders/surface/cit.frag.
    const float diffuse = 1.0f - metallic + 0.5f * metallic * roughness * roughness;
    const glm::vec4 base = texel(material.baseColorTexture, mesh_.baseUv, true);
    return {between(mesh_.colors, triangle, weights) * base * diffuse,
            texel(material.emissionTexture, mesh_.emissionUv, true)};
}

bool SurfaceReader::isSolid(uint32_t triangle, const glm::vec3& weights) const {
    const Mask& mask = masks_[mesh_.material[triangle]];
    shader::ImageAlpha alpha{mask.image};
    return alpha.alphaSolid(alphaTriangle(mesh_, triangle, 0), mask.material, weights.y, weights.z);
}

double SurfaceReader::maskTexels(uint32_t triangle, const glm::dvec3& edge) const {
    const Mask& mask = masks_[mesh_.material[triangle]];
    // The alpha of the corners alone has no texels: it counts as if it had some.
    constexpr double kOfCorners = 64;
    const glm::vec4* c = &mesh_.colors[size_t{triangle} * 3];
    const bool even = c[0].a == c[1].a && c[0].a == c[2].a;
    const double ofCorners = even ? 0.0 : kOfCorners * glm::length(edge);
    if (mask.image == nullptr) return ofCorners;
    const glm::vec2* uv = &mesh_.baseUv[size_t{triangle} * 3];
    const glm::dvec2 way =
        edge.x * glm::dvec2(uv[0]) + edge.y * glm::dvec2(uv[1]) + edge.z * glm::dvec2(uv[2]);
    return std::max(ofCorners, glm::length(way * glm::dvec2(mask.image->width, mask.image->height)));
}

} // namespace relume
