#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "assets/base/warnings.h"
#include "assets/model/scene_edits.h"
#include "renderer/gl/buffer.h"
#include "renderer/gl/texture.h"
#include "renderer/gl/vertex_array.h"
#include "renderer/scene_geometry.h"
#include "renderer/version.h"

namespace relume {

/// Returns what brings points of an instance from where it stood to where it stands, or the identity where it
/// had no volume.
glm::mat4 placementBetween(const glm::mat4& from, const glm::mat4& to);

/// Holds a scene in OpenGL's memory: vertices, textures with their mips, materials. It belongs to the context
/// that is current when it is made, and needs neither scene nor mesh afterwards.
class SceneGpu {
public:
    /// Holds the textures of one material; 0: none.
    struct MaterialTextures {
        GLuint base = 0, emission = 0, metallic = 0;
        bool masked = false; // has holes
    };
    /// Tells where an instance stands, seen from where it was when this was made.
    struct Place {
        glm::mat4 transform{1.0f};
        glm::mat3 normals{1.0f}; // of any length
        bool hidden = false, mirrored = false;
    };
    // Floors seen at a flat angle are blurred without it; more than 8 samples show no difference.
    static constexpr float kAnisotropy = 8.0f;

    /// Images that are too large for the driver are made smaller, with a warning. Throws Error where there is
    /// no memory.
    SceneGpu(const Scene& scene, const WorldMesh& mesh);
    /// Takes a geometry that was made before, beside the thread that draws.
    SceneGpu(const Scene& scene, const SceneGeometry& geometry);

    /// Takes the factors of the scene's materials anew: base colour, emission, metallic, roughness. Textures,
    /// the alpha mode and the number of materials must be as they were.
    void updateMaterials(const Scene& scene);
    /// Lets instances be drawn where these placements are, of which there are as many as the scene has
    /// instances.
    void updatePlacements(const std::vector<Placement>& placements);
    /// Takes the sky as it is set now. Another picture than the one that is here is not drawn.
    void updateSky(const SkySettings& sky);
    /// Takes the picture of the sky's file.
    void updateSkyPicture(const Sky& sky);
    const std::string& skyFile() const { return skyFile_; } // whose picture is here, "": none
    /// Sets the number of samples along the longer side of what a pixel covers of a texture, at most
    /// kAnisotropy. With 1 there is no anisotropy, which spares a software device a little of a textured
    /// scene's time and blurs its floors.
    void setAnisotropy(float samples);

    const std::vector<SceneDraw>& draws() const { return draws_; }
    const Place& place(uint32_t instance) const { return places_[instance]; }
    /// Returns the bounds of a draw as it is placed.
    Box boundsOf(const SceneDraw& draw) const;
    const MaterialTextures& textures(uint32_t material) const { return textures_[material]; }
    const SkySettings& sky() const { return sky_; }
    GLuint skyPicture() const { return sky_.file == skyFile_ ? skyPicture_.get() : 0; } // 0: one radiance
    const Box& bounds() const { return bounds_; }
    float medianDensity() const { return medianDensity_; } // as SceneGeometry has it
    const gl::VertexArray& vertexArray() const { return vertexArray_; }
    const gl::Buffer& materials() const { return materials_; } // SceneMaterial[], the default one last
    uint64_t version() const { return version_; }              // another one when it looks different

private:
    GLuint textureOf(const Scene& scene, const TextureRef& use, bool srgb, Warnings& warnings);

    std::vector<SceneDraw> draws_;
    std::vector<Placement> made_, placements_; // of the instances: when this was made, and now
    std::vector<Place> places_;                // that follow from them
    Box bounds_;
    float medianDensity_ = 0;
    gl::Buffer vertices_, indices_, materials_;
    gl::VertexArray vertexArray_;
    std::map<std::pair<int, bool>, gl::Texture> loaded_; // by Scene::textures and whether it is sRGB
    SkySettings sky_;
    std::string skyFile_; // whose picture this is:
    gl::Texture skyPicture_;
    std::vector<MaterialTextures> textures_; // the default material's last
    uint64_t version_ = newVersion();
};

} // namespace relume
