#include "renderer/scene_gpu.h"

#include "renderer/shader_types.h"

#include <array>
#include <cstddef>

namespace relume {
namespace {

GLint wrapOf(Wrap wrap) {
    return wrap == Wrap::ClampToEdge      ? GL_CLAMP_TO_EDGE
           : wrap == Wrap::MirroredRepeat ? GL_MIRRORED_REPEAT
                                          : GL_REPEAT;
}

gl::Texture makeTexture(const Scene& scene, const Texture& texture, bool srgb) {
    const Image& image = scene.images[static_cast<size_t>(texture.image)];
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
    // Floors seen at a flat angle are blurred without it; more than 8 samples show no difference.
    constexpr float kAnisotropy = 8.0f;
    if (epoxy_has_gl_extension("GL_ARB_texture_filter_anisotropic") ||
        epoxy_has_gl_extension("GL_EXT_texture_filter_anisotropic")) {
        glTextureParameterf(made.get(), GL_TEXTURE_MAX_ANISOTROPY, kAnisotropy);
    }
    return made;
}

shader::SceneMaterial describe(const Material& material) {
    shader::SceneMaterial result;
    result.baseColor = material.baseColor;
    const bool masked = material.alphaMode == AlphaMode::Mask;
    result.emission = glm::vec4(material.emission, masked ? material.alphaCutoff : 0.0f);
    result.metallic = glm::vec4(material.metallic, material.roughness, 0.0f, 0.0f);
    return result;
}

} // namespace

GLuint SceneGpu::textureOf(const Scene& scene, const TextureRef& use, bool srgb) {
    if (use.texture < 0) return white_.get();
    const Texture& texture = scene.textures[static_cast<size_t>(use.texture)];
    if (texture.image < 0) return white_.get();
    gl::Texture& slot = loaded_[{use.texture, srgb}];
    if (slot.get() == 0) slot = makeTexture(scene, texture, srgb);
    return slot.get();
}

SceneGpu::SceneGpu(const Scene& scene, const WorldMesh& mesh) {
    SceneGeometry geometry = makeGeometry(scene, mesh);
    draws_ = std::move(geometry.draws);
    bounds_ = geometry.bounds;
    medianDensity_ = geometry.medianDensity;
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

    white_ = gl::Texture({.width = 1, .height = 1, .name = "white"});
    const std::array<uint8_t, 4> white = {255, 255, 255, 255};
    white_.upload(GL_RGBA, GL_UNSIGNED_BYTE, white.data());
    std::vector<shader::SceneMaterial> materials;
    std::vector<Material> all = scene.materials;
    all.emplace_back(); // glTF's default material
    for (const Material& material : all) {
        materials.push_back(describe(material));
        textures_.push_back({textureOf(scene, material.baseColorTexture, true),
                             textureOf(scene, material.emissionTexture, true),
                             textureOf(scene, material.metallicRoughnessTexture, false)});
    }
    materials_ = gl::Buffer::of<shader::SceneMaterial>(materials, "materials");
}

} // namespace relume
