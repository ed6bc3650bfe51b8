#pragma once

#include "renderer/draw_settings.h"
#include "renderer/gl/program_cache.h"
#include "renderer/gl/screen.h"
#include "renderer/lightmap_texture.h"
#include "renderer/scene_renderer.h"

namespace relume {

/// Tells where a picture shows the texture of a lightmap, row 0 on top.
struct UvWindow {
    glm::vec2 centre{0.5f}; // uv in the picture's middle
    float zoom = 1.0f;      // 1: all of the texture just fits
};
/// Returns the uv at a pixel of a picture, counted from its upper left corner; it is outside of [0, 1] beside
/// the texture.
glm::vec2 uvAt(const UvWindow& window, const glm::vec2& pixel, const glm::vec2& size);
/// Returns the pixel at which a uv is; it inverts uvAt().
glm::vec2 pixelAt(const UvWindow& window, const glm::vec2& uv, const glm::vec2& size);
/// Moves by pixels, as a drag does.
UvWindow pan(const UvWindow& window, const glm::vec2& pixels, const glm::vec2& size);
/// Scales about a pixel; a factor > 1 comes closer.
UvWindow zoom(const UvWindow& window, float factor, const glm::vec2& pixel, const glm::vec2& size);

/// Draws the texture of a lightmap flat.
class UvView {
public:
    struct Settings {
        UvWindow window;
        bool masked = true; // empty texels are hatched; else they are shown as they are
        // The view is one of light (Lit, Lighting, InspectColor), Coverage or another view that inspects; the
        // rest count as light. Without an exposure, it is 0 EV.
        DrawSettings draw;
    };
    UvView(); // throws Error when its shader does not compile

    /// Fills the target. A lightmap without a texture leaves the background.
    void draw(const LightmapTexture& lightmap, const Settings& settings, const SceneRenderer::Target& target);
    /// Compiles its programs again. Throws Error and keeps the old ones when one fails.
    void reload() { programs_ = programs_.reloaded(); }

private:
    const gl::Program& program(const LightmapTexture& lightmap, const DrawSettings& settings);

    gl::ProgramCache programs_;
    gl::Screen screen_;
};

} // namespace relume
