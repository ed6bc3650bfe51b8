#include "renderer/uv_view.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace relume {
namespace {

// These are the uniforms, as uv.frag and what it includes number them.
constexpr GLint kUvWindow = 0, kUvTargetSize = 1, kUvMasked = 2, kUvBackground = 3, kUvMeterScale = 7,
                kUvExposure = 9, kUvUnit = 10, kUvRangeLow = 11, kUvRangeHigh = 12, kUvDither = 15;
constexpr GLuint kUvLightmapUnit = 3;
constexpr float kFarthestZoom = 0.1f,
                kClosestZoom = 4096.0f; // zoom: a texel of the largest lightmap fills a window

float uvPerPixel(const UvWindow& window, const glm::vec2& size) {
    return 1.0f / (window.zoom * std::max(1.0f, std::min(size.x, size.y)));
}

View shownView(View view) {
    return view == View::Coverage || view > View::InspectColor ? view : View::InspectColor;
}

} // namespace

glm::vec2 uvAt(const UvWindow& window, const glm::vec2& pixel, const glm::vec2& size) {
    return window.centre + uvPerPixel(window, size) * (pixel - 0.5f * size);
}

glm::vec2 pixelAt(const UvWindow& window, const glm::vec2& uv, const glm::vec2& size) {
    return 0.5f * size + (uv - window.centre) / uvPerPixel(window, size);
}

UvWindow pan(const UvWindow& window, const glm::vec2& pixels, const glm::vec2& size) {
    UvWindow moved = window;
    moved.centre = glm::clamp(window.centre - uvPerPixel(window, size) * pixels, 0.0f, 1.0f);
    return moved;
}

UvWindow zoom(const UvWindow& window, float factor, const glm::vec2& pixel, const glm::vec2& size) {
    UvWindow moved = window;
    moved.zoom = std::clamp(window.zoom * factor, kFarthestZoom, kClosestZoom);
    moved.centre += uvAt(window, pixel, size) - uvAt(moved, pixel, size);
    return moved;
}

UvView::UvView() {
    program({}, {}); // what is wrong with it shows now
}

const gl::Program& UvView::program(const LightmapTexture& lightmap, const DrawSettings& settings) {
    const auto view = static_cast<uint32_t>(shownView(settings.view)),
               filter = static_cast<uint32_t>(settings.filter), tone = static_cast<uint32_t>(settings.tone),
               filled = lightmap.filled ? 1u : 0u;
    return programs_.get(view | filter << 5 | tone << 7 | filled << 9, [&]() -> gl::Program::Desc {
        const auto define = [](const char* name, uint32_t value) {
            return std::string(name) + "=" + std::to_string(value) + "u";
        };
        return {.vertex = "gl/screen.vert",
                .fragment = "gl/uv.frag",
                .definitions = {define("VIEW", view), define("FILTER", filter), define("TONE", tone),
                                define("FILLED", filled)},
                .name = "texture"};
    });
}

void UvView::draw(const LightmapTexture& lightmap, const Settings& settings,
                  const SceneRenderer::Target& target) {
    const DrawSettings& draw = settings.draw;
    if (lightmap.texture == 0) {
        const std::array<float, 4> nothing = {draw.background.r, draw.background.g, draw.background.b, 1.0f};
        glDisable(GL_SCISSOR_TEST);
        glClearNamedFramebufferfv(target.framebuffer, GL_COLOR, 0, nothing.data());
        return;
    }
    const glm::vec2 size(target.width, target.height);
    const glm::vec2 corner = uvAt(settings.window, glm::vec2(0.0f), size);
    const gl::Program& shown = program(lightmap, draw);
    shown.set(kUvWindow, glm::vec4(corner, glm::vec2(uvPerPixel(settings.window, size))));
    shown.set(kUvTargetSize, size);
    shown.set(kUvMasked, static_cast<GLuint>(settings.masked ? 1 : 0));
    shown.set(kUvBackground, draw.background);
    shown.set(kUvMeterScale, 1.0f);
    shown.set(kUvExposure, std::exp2(draw.exposure.value_or(0.0f)));
    shown.set(kUvDither, draw.dither ? 1.0f : 0.0f);
    shown.set(kUvUnit, lightmap.unit);
    shown.set(kUvRangeLow, draw.rangeLow);
    shown.set(kUvRangeHigh, draw.rangeHigh);
    glBindTextureUnit(kUvLightmapUnit, lightmap.texture);
    screen_.draw(shown, target.framebuffer, target.width, target.height);
}

} // namespace relume
