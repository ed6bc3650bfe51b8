#include "renderer/scene_gpu.h"

#include "assets/base/error.h"
#include "assets/base/log.h"
#include "assets/images/box_filter.h"
#include "renderer/shader_types.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include <glm/gtc/matrix_inverse.hpp>

namespace relume {
namespace {

GLint wrapOf(Wrap wrap) {
    return wrap == Wrap::ClampToEdge      ? GL_CLAMP_TO_EDGE
           : wrap == Wrap::MirroredRepeat ? GL_MIRRORED_REPEAT
                                          : GL_REPEAT;
}

gl::Texture makeTexture(const Scene& scene, const Texture& texture, bool srgb, Warnings& warnings) {
    const Image& source = scene.images[static_cast<size_t>(texture.image)];
    const uint32_t most = gl::largestTexture();
    const bool fits = std::max(source.width, source.height) <= most;
    if (!fits) warnings.add(imageName(scene, texture.image), tooLarge(source.width, source.height, most));
    const Image smaller = fits ? Image() : shrunkTo(most, source, srgb);
    const Image& image = fits ? source : smaller;
    gl::Texture made({.width = image.width,
                      .height = image.height,
                      .format = static_cast<GLenum>(srgb ? GL_SRGB8_ALPHA8 : GL_RGBA8),
                      .mips = 0,
                      .name = image.name.c_str()});
    made.upload(GL_RGBA, GL_UNSIGNED_BYTE, image.rgba.data());
    made.generateMips();
    glTextureParameteri(made.get(), GL_TEXTURE_WRAP_S, wrapOf(texture.wrapS));
    glTextureParameteri(made.get(), GL_TEXTURE_WRAP_T, wrapOf(texture.wrapT));
    if (texture.nearest) glTextureParameteri(made.get(), GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    return made;
}

gl::Texture makeSkyPicture(const Sky& whole, Warnings& warnings) {
    const uint32_t most = gl::largestTexture();
    const bool fits = std::max(whole.width, whole.height) <= most;
    Sky smaller;
    if (!fits) {
        warnings.add("sky " + inQuotes(whole.file), tooLarge(whole.width, whole.height, most));
        smaller = whole;
        shrinkTo(most, smaller);
    }
    const Sky& sky = fits ? whole : smaller;
    // Values that half floats cannot hold would be infinite, which no tone mapping brings back.
    constexpr float kMostHalf = 65504.0f;
    std::vector<glm::vec3> pixels = sky.pixels;
    for (glm::vec3& pixel : pixels)
        pixel = glm::min(pixel, kMostHalf);
    gl::Texture made({.width = sky.width, .height = sky.height, .format = GL_RGB16F, .name = "sky"});
    made.upload(GL_RGB, GL_FLOAT, pixels.data());
    glTextureParameteri(made.get(), GL_TEXTURE_WRAP_S, GL_REPEAT); // all around
    return made;
}

bool canFilterAnisotropically() {
    return epoxy_has_gl_extension("GL_ARB_texture_filter_anisotropic") ||
           epoxy_has_gl_extension("GL_EXT_texture_filter_anisotropic");
}

shader::SceneMaterial describe(const Material& material) {
    shader::SceneMaterial result;
    result.baseColor = material.baseColor;
    const bool masked = material.alphaMode == AlphaMode::Mask;
    result.emission = glm::vec4(material.emission, masked ? material.alphaCutoff : 0.0f);
    const bool blends = material.alphaMode == AlphaMode::Blend;
    result.metallic =
        glm::vec4(material.metallic, material.roughness, material.transmission, blends ? 1.0f : 0.0f);
    return result;
}

std::vector<shader::SceneMaterial> describeAll(const Scene& scene) {
    std::vector<shader::SceneMaterial> materials;
    materials.reserve(scene.materials.size() + 1);
    for (const Material& material : scene.materials)
        materials.push_back(describe(material));
    materials.push_back(describe({})); // glTF's default material
    return materials;
}

void logAll(const Warnings& warnings, const std::string& path) {
    for (const std::string& warning : warnings.lines(path))
        spdlog::warn("{}", warning);
}

} // namespace

glm::mat4 placementBetween(const glm::mat4& from, const glm::mat4& to) {
    if (std::abs(glm::determinant(glm::mat3(from))) < std::numeric_limits<float>::min())
        return glm::mat4(1.0f);
    return to * glm::inverse(from);
}

GLuint SceneGpu::textureOf(const Scene& scene, const TextureRef& use, bool srgb, Warnings& warnings) {
    if (use.texture < 0) return 0;
    const Texture& texture = scene.textures[static_cast<size_t>(use.texture)];
    if (texture.image < 0) return 0;
    gl::Texture& slot = loaded_[{use.texture, srgb}];
    if (slot.get() == 0) slot = makeTexture(scene, texture, srgb, warnings);
    return slot.get();
}

SceneGpu::SceneGpu(const Scene& scene, const WorldMesh& mesh) : SceneGpu(scene, makeGeometry(scene, mesh)) {}

SceneGpu::SceneGpu(const Scene& scene, const SceneGeometry& geometry)
    : draws_(geometry.draws), bounds_(geometry.bounds), medianDensity_(geometry.medianDensity) {
    vertices_ = gl::Buffer::of<SceneVertex>(geometry.vertices, "scene vertices");
    indices_ = gl::Buffer::of<uint32_t>(geometry.indices, "scene indices");
    const std::array<gl::VertexAttribute, 8> attributes = {{
        {3, GL_FLOAT, offsetof(SceneVertex, position)},
        {3, GL_FLOAT, offsetof(SceneVertex, normal)},
        {2, GL_FLOAT, offsetof(SceneVertex, baseUv)},
        {2, GL_FLOAT, offsetof(SceneVertex, emissionUv)},
        {2, GL_FLOAT, offsetof(SceneVertex, metallicUv)},
        {2, GL_FLOAT, offsetof(SceneVertex, lightmapUv)},
        {4, GL_FLOAT, offsetof(SceneVertex, color)},
        {2, GL_UNSIGNED_INT, offsetof(SceneVertex, instance)},
    }};
    vertexArray_ = gl::VertexArray({.vertices = &vertices_,
                                    .indices = &indices_,
                                    .stride = sizeof(SceneVertex),
                                    .attributes = attributes,
                                    .name = "scene"});

    Warnings warnings;
    for (const Material& material : scene.materials)
        textures_.push_back({textureOf(scene, material.baseColorTexture, true, warnings),
                             textureOf(scene, material.emissionTexture, true, warnings),
                             textureOf(scene, material.metallicRoughnessTexture, false, warnings),
                             material.alphaMode == AlphaMode::Mask});
    textures_.emplace_back();
    const std::vector<shader::SceneMaterial> materials = describeAll(scene);
    materials_ = gl::Buffer({.size = static_cast<GLsizeiptr>(materials.size() * sizeof(materials[0])),
                             .data = materials.data(),
                             .flags = GL_DYNAMIC_STORAGE_BIT,
                             .name = "materials"});
    made_ = placements_ = editsOf(scene).placements;
    places_.resize(made_.size());
    for (size_t i = 0; i < made_.size(); ++i)
        places_[i].hidden = made_[i].hidden;
    sky_ = scene.sky;
    skyFile_ = sky_.file;
    if (!scene.sky.pixels.empty()) skyPicture_ = makeSkyPicture(scene.sky, warnings);
    logAll(warnings, scene.path);
    setAnisotropy(kAnisotropy);
}

void SceneGpu::updatePlacements(const std::vector<Placement>& placements) {
    ASSERT(placements.size() == made_.size());
    if (placements_ == placements) return;
    placements_ = placements;
    for (size_t i = 0; i < made_.size(); ++i) {
        places_[i] = {};
        places_[i].hidden = placements[i].hidden;
        if (placements[i].transform == made_[i].transform) continue;
        places_[i].transform = placementBetween(made_[i].transform, placements[i].transform);
        const glm::mat3 turned(places_[i].transform);
        places_[i].normals = glm::inverseTranspose(turned);
        places_[i].mirrored = glm::determinant(turned) < 0.0f;
    }
    bounds_ = {};
    for (const SceneDraw& draw : draws_)
        bounds_.add(boundsOf(draw));
    version_ = newVersion();
}

Box SceneGpu::boundsOf(const SceneDraw& draw) const {
    const Place& place = places_[draw.instance];
    return place.transform == glm::mat4(1.0f) ? draw.bounds : transformed(draw.bounds, place.transform);
}

void SceneGpu::updateSky(const SkySettings& sky) {
    if (sky_ == sky) return;
    sky_ = sky;
    version_ = newVersion();
}

void SceneGpu::updateSkyPicture(const Sky& sky) {
    skyPicture_ = {}; // before the new one takes its memory
    skyFile_.clear(); // which it may not get
    Warnings warnings;
    skyPicture_ = makeSkyPicture(sky, warnings);
    logAll(warnings, "");
    skyFile_ = sky.file;
    version_ = newVersion();
}

void SceneGpu::updateMaterials(const Scene& scene) {
    const std::vector<shader::SceneMaterial> materials = describeAll(scene);
    ASSERT(materials.size() == textures_.size());
    glNamedBufferSubData(materials_.get(), 0,
                         static_cast<GLsizeiptr>(materials.size() * sizeof(materials[0])), materials.data());
    version_ = newVersion();
}

void SceneGpu::setAnisotropy(float samples) {
    if (!canFilterAnisotropically()) return;
    for (const auto& [use, texture] : loaded_)
        glTextureParameterf(texture.get(), GL_TEXTURE_MAX_ANISOTROPY, std::clamp(samples, 1.0f, kAnisotropy));
    version_ = newVersion();
}

} // namespace relume
