#pragma once

#include <optional>

#include "renderer/ball_draw.h"
#include "renderer/camera.h"
#include "renderer/draw_settings.h"
#include "renderer/exposure_meter.h"
#include "renderer/gl/framebuffer.h"
#include "renderer/gl/program_cache.h"
#include "renderer/gl/timer.h"
#include "renderer/gl/vertex_array.h"
#include "renderer/lightmap_texture.h"
#include "renderer/overlays.h"
#include "renderer/scene_gpu.h"

namespace relume {

/// Draws a scene with its lightmap. It works in whatever context is current when it is made, a window's or a
/// headless one. It keeps the last picture, so that a viewer can show it again.
class SceneRenderer {
public:
    /// Says where the finished picture goes, in sRGB encoding.
    struct Target {
        GLuint framebuffer = 0; // 0: the window's; its format is an ordinary one, not GL_SRGB8
        uint32_t width = 0, height = 0;
    };
    /// Says what one picture shows.
    struct Frame {
        const SceneGpu& scene;
        LightmapTexture lightmap;
        ViewCamera camera;
        DrawSettings settings;
        const LineDraw* lines = nullptr;   // over the scene
        const VoxelDraw* voxels = nullptr; // in the scene's place
        const BallDraw* balls = nullptr;   // in the scene, in views of light
    };
    struct Counts {
        uint32_t drawn = 0, culled = 0; // SceneDraws
    };
    /// Says how automatic exposure works: Wait measures the picture that is drawn, as one shot needs; Async
    /// never waits for the device and takes what earlier pictures measured, as a viewer needs.
    enum class Metering { Wait, Async };

    /// Takes the samples of each pixel; 0 or 1: no multisampling. Throws Error when a shader does not compile
    /// (draw throws it for that of another view) or the context is older than OpenGL 4.5.
    explicit SceneRenderer(uint32_t samples = 4, Metering metering = Metering::Wait);

    /// Shows the frame; draws it only where it is not what the last picture shows already. Returns whether it
    /// drew. Throws Error when the target's size does not fit in memory.
    bool draw(const Frame& frame, const Target& target);
    /// Shows the last picture again, scaled where the target has another size; nothing before the first.
    void present(const Target& target);
    /// Returns true until the right exposure of the last picture is known and drawn: draw again soon.
    bool adapting() const;

    /// Sets the exposure [EV] that automatic exposure takes for the next picture until it is measured, where
    /// Metering is Async. Thus a view that was seen before comes back without a jump.
    void expectExposure(float exposure) {
        measured_ = exposure;
        measuredLight_.reset();
    }

    /// Sets the samples of the next pictures, or the driver's largest number where it has fewer.
    void setSamples(uint32_t samples);
    /// Compiles the programs in use again, from --shaders' folder. Throws Error and keeps them all when one
    /// fails.
    void reload();

    const Counts& counts() const { return counts_; }            // of the last picture
    float exposure() const { return exposure_; }                // of the last picture of light [EV]
    const gl::Framebuffer& picture() const { return picture_; } // the last one, its alpha means nothing
    gl::Timer& timer() { return timer_; } // its passes are measured; whoever ends frames calls endFrame

private:
    /// Holds all that makes a picture what it is.
    struct Shown {
        uint64_t scene = 0, lines = 0, voxels = 0, balls = 0; // versions
        LightmapTexture lightmap;
        ViewCamera camera;
        DrawSettings settings;
        uint32_t width = 0, height = 0;
        float exposure = 0; // [EV]

        bool operator==(const Shown&) const = default;
    };
    struct Pass { // what the draws of a frame share
        glm::mat4 viewProjection{1.0f};
        float meterScale = 1.0f, exposure = 0.0f, dither = 0.0f;
    };

    Shown describe(const Frame& frame, const Target& target) const;
    float exposureFor(const Frame& frame) const;
    void takeMeasurement(bool wait);
    void measure(const Frame& frame);
    void resize(uint32_t width, uint32_t height);
    void render(const Frame& frame, float exposure);
    void resolve();
    void drawScene(const Frame& frame, const Pass& pass);
    void drawPanes(const Frame& frame, const Pass& pass);
    void drawAll(const Frame& frame, const Pass& pass, const std::vector<const SceneDraw*>& draws);
    void drawSky(const Frame& frame, const Pass& pass);
    void drawVoxels(const Frame& frame, const Pass& pass);
    void drawLines(const Frame& frame, const Pass& pass);
    void drawBalls(const Frame& frame, const Pass& pass);
    const gl::Program& sceneProgram(const Frame& frame, const SceneDraw& draw);
    static void setDisplay(const gl::Program& program, const Pass& pass);
    void setUniforms(const gl::Program& program, const Frame& frame, const Pass& pass) const;
    const gl::Framebuffer& surface() const { return samples_ > 0 ? multisampled_ : picture_; }

    uint32_t samples_ = 0;
    Metering metering_;
    gl::ProgramCache programs_;
    ExposureMeter meter_;
    gl::VertexArray empty_;                  // without vertices
    gl::Framebuffer multisampled_, picture_; // the first is resolved into the second
    gl::Timer timer_;
    std::optional<Shown> shown_;    // none: draw in any case
    bool unmeasured_ = false;       // the last picture's light is not what was measured last
    std::optional<float> measured_; // the newest exposure that a picture asked for [EV]
    // The mean light of the pictures that were measured, and that are, where it is known [cd/m^2].
    std::optional<float> measuredLight_, pendingLight_;
    Counts counts_;
    float exposure_ = 0;
};

} // namespace relume
