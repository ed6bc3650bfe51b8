#pragma once

#include <map>
#include <utility>
#include <vector>

#include "renderer/gl/buffer.h"
#include "renderer/gl/texture.h"
#include "renderer/gl/vertex_array.h"
#include "renderer/scene_geometry.h"

namespace relume {

/// A scene in OpenGL's memory: vertices, textures with their mips, materials. Belongs to the context that is
/// current when it is made; needs neither scene nor mesh afterwards.
class SceneGpu {
public:
    /// Textures of one material; never 0: white where it has none.
    struct MaterialTextures {
        GLuint base = 0, emission = 0, metallic = 0;
    };

    SceneGpu(const Scene& scene, const WorldMesh& mesh); // throws Error when it does not fit

    const std::vector<SceneDraw>& draws() const { return draws_; }
    const MaterialTextures& textures(uint32_t material) const { return textures_[material]; }
    const Box& bounds() const { return bounds_; }
    float medianDensity() const { return medianDensity_; } // as SceneGeometry has it
    const gl::VertexArray& vertexArray() const { return vertexArray_; }
    const gl::Buffer& materials() const { return materials_; } // SceneMaterial[], the default one last

private:
    GLuint textureOf(const Scene& scene, const TextureRef& use, bool srgb);

    std::vector<SceneDraw> draws_;
    Box bounds_;
    float medianDensity_ = 0;
    gl::Buffer vertices_, indices_, materials_;
    gl::VertexArray vertexArray_;
    gl::Texture white_;
    std::map<std::pair<int, bool>, gl::Texture> loaded_; // by Scene::textures and whether it is sRGB
    std::vector<MaterialTextures> textures_;             // the default material's last
};

} // namespace relume
