#pragma once

#include <map>
#include <utility>

#include "renderer/camera.h"
#include "renderer/draw_settings.h"
#include "renderer/gl/framebuffer.h"
#include "renderer/gl/program.h"
#include "renderer/gl/vertex_array.h"
#include "renderer/lightmap_texture.h"
#include "renderer/scene_gpu.h"

namespace relume {

/// Draws a scene with its lightmap. Works in whatever context is current when it is made, a window's or a
/// headless one.
class SceneRenderer {
public:
    /// Where the finished picture goes, in sRGB encoding.
    struct Target {
        GLuint framebuffer = 0; // 0: the window's; its format is an ordinary one, not GL_SRGB8
        uint32_t width = 0, height = 0;
    };
    /// What one picture shows.
    struct Frame {
        const SceneGpu& scene;
        LightmapTexture lightmap;
        ViewCamera camera;
        DrawSettings settings;
    };
    struct Counts {
        uint32_t drawn = 0, culled = 0; // SceneDraws
    };

    /// samples of each pixel, 0 or 1: no multisampling. Throws Error when a shader does not compile (draw:
    /// that of another view) or the context is older than OpenGL 4.5.
    explicit SceneRenderer(uint32_t samples = 4);

    void draw(const Frame& frame,
              const Target& target); // throws Error when the target's size does not fit in memory

    const Counts& counts() const { return counts_; } // of the last picture
    float exposure() const { return exposure_; }     // of the last picture of light [EV]

private:
    const gl::Program& sceneProgram(const DrawSettings& settings);
    void resize(const Target& target);
    void drawScene(const Frame& frame, float preScale);
    float measureExposure(float preScale);

    uint32_t samples_;
    std::map<std::pair<View, LightmapFilter>, gl::Program> scenePrograms_; // made when first used
    gl::Program meterProgram_, displayProgram_;
    gl::VertexArray screen_; // without vertices
    gl::Framebuffer picture_, meter_;
    Counts counts_;
    float exposure_ = 0;
};

} // namespace relume
