#include "renderer/scene_renderer.h"

#include "renderer/gl/debug.h"
#include "renderer/visible_draws.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace relume {
namespace {

// These are the uniforms, as the shaders number them.
constexpr GLint kViewProjection = 0, kMaterial = 1, kEye = 4, kAmbient = 5, kLightmapSize = 6,
                kMeterScale = 7, kMedianDensity = 8, kExposure = 9, kUnit = 10, kRangeLow = 11,
                kRangeHigh = 12, kDither = 15;
constexpr GLint kLineOpacity = 1, kVoxelEdge = 1, kVoxelColored = 2, kVoxelEye = 3, kBallEye = 3;
constexpr GLint kSkyAhead = 0, kSkyAcross = 1, kSkyAbove = 2, kSkySize = 3, kSkyRadiance = 4,
                kSkyRotation = 5;
constexpr GLuint kLightmapUnit = 3;
// These are keys of programs; those of the scene are below.
constexpr uint32_t kBallProgram = 1u << 28, kSkyProgram = 1u << 29, kLineProgram = 1u << 30,
                   kVoxelProgram = 1u << 31;

constexpr float kSameExposure = 0.02f; // [EV], 1.4 %: less than one step of 8 bits
// A picture is black or white where its mean light is so many stops from that of the picture whose exposure
// it takes, as when the first light comes.
constexpr float kOtherLight = 2.0f;

// Brings the light of any unit near 1, where the meter's scale has its middle.
float meterScaleOf(const LightmapTexture& lightmap) {
    const float mean = shader::luminance(lightmap.ambient);
    return mean > 0.0f && std::isfinite(mean) ? 1.0f / mean : 1.0f;
}

// Guesses the exposure before anything was measured: the mean light on a surface of albedo one half is a
// middle grey.
float guessExposure(const LightmapTexture& lightmap) {
    constexpr float kMiddleGrey = 0.18f, kAlbedo = 0.5f;
    return std::log2(kMiddleGrey / kAlbedo * meterScaleOf(lightmap));
}

bool fetchesAlbedo(View view) {
    return view == View::Lit || view == View::Albedo;
}

bool fetchesEmission(View view) {
    return view == View::Lit || view == View::Emission;
}

/// Tells what a variant of scene.frag is compiled for, in the order of its definitions.
struct Variant {
    uint32_t view = 0, filter = 0, tone = 0, base = 0, emission = 0, metallic = 0, masked = 0, mapped = 0,
             selected = 0, filled = 0, pane = 0;

    uint32_t key() const {
        return view | filter << 5 | tone << 7 | base << 9 | emission << 10 | metallic << 11 | masked << 12 |
               mapped << 13 | selected << 15 | filled << 16 | pane << 17;
    }
    std::vector<std::string> definitions() const {
        const auto define = [](const char* name, uint32_t value) {
            return std::string(name) + "=" + std::to_string(value) + "u";
        };
        return {define("VIEW", view),     define("FILTER", filter),     define("TONE", tone),
                define("BASE", base),     define("EMISSION", emission), define("METALLIC", metallic),
                define("MASKED", masked), define("MAPPED", mapped),     define("SELECTED", selected),
                define("FILLED", filled), define("PANE", pane)};
    }
};

// Returns the variant. There are no more of them than different programs: what a view does not look at is
// left out.
Variant variantOf(const DrawSettings& settings, const SceneDraw& draw,
                  const SceneGpu::MaterialTextures& textures, const LightmapTexture& lightmap) {
    const View view = settings.view;
    const bool lightless = readsLightmap(view) && lightmap.texture == 0;
    Variant variant;
    variant.view = static_cast<uint32_t>(view);
    if (readsLightmap(view)) variant.filter = static_cast<uint32_t>(settings.filter);
    if (showsLight(view)) variant.tone = static_cast<uint32_t>(settings.tone);
    variant.masked = textures.masked ? 1 : 0;
    variant.pane = draw.pane ? 1 : 0;
    variant.base = textures.base != 0 && (fetchesAlbedo(view) || textures.masked || draw.pane) ? 1 : 0;
    variant.emission = textures.emission != 0 && fetchesEmission(view) ? 1 : 0;
    variant.metallic = textures.metallic != 0 && fetchesAlbedo(view) ? 1 : 0;
    variant.filled = readsLightmap(view) && lightmap.filled ? 1 : 0;
    variant.mapped = lightless ? shader::kMappedNone : draw.mapped;
    variant.selected =
        settings.selected >= 0 && draw.instance == static_cast<uint32_t>(settings.selected) ? 1 : 0;
    return variant;
}

void clear(const gl::Framebuffer& surface, const glm::vec3& background) {
    const std::array<float, 4> color = {background.r, background.g, background.b, 0.0f}; // no light
    const float farAway = 0;
    glClearNamedFramebufferfv(surface.get(), GL_COLOR, 0, color.data());
    glClearNamedFramebufferfv(surface.get(), GL_DEPTH, 0, &farAway);
}

} // namespace

SceneRenderer::SceneRenderer(uint32_t samples, Metering metering)
    : metering_((gl::requireOpenGl45(), metering)), empty_({.attributes = {}, .name = "empty"}) {
    setSamples(samples);
    // A fault of the shader shows now.
    const DrawSettings usual;
    const Variant plain{.filter = static_cast<uint32_t>(usual.filter),
                        .tone = static_cast<uint32_t>(usual.tone),
                        .mapped = shader::kMappedAll,
                        .filled = 1};
    programs_.get(plain.key(), [&]() -> gl::Program::Desc {
        return {.vertex = "gl/scene.vert",
                .fragment = "gl/scene.frag",
                .definitions = plain.definitions(),
                .name = "scene"};
    });
}

void SceneRenderer::setSamples(uint32_t samples) {
    GLint most = 0;
    glGetIntegerv(GL_MAX_COLOR_TEXTURE_SAMPLES, &most);
    const uint32_t wanted = samples > 1 ? std::min(samples, static_cast<uint32_t>(most)) : 0;
    if (wanted == samples_) return;
    samples_ = wanted;
    multisampled_ = {};
    picture_ = {};
    shown_.reset();
}

void SceneRenderer::reload() {
    // Both are reloaded or none: programs_ changes only once the meter's programs have compiled, too.
    gl::ProgramCache programs = programs_.reloaded();
    meter_.reload();
    programs_ = std::move(programs);
    shown_.reset();
}

const gl::Program& SceneRenderer::sceneProgram(const Frame& frame, const SceneDraw& draw) {
    const Variant variant =
        variantOf(frame.settings, draw, frame.scene.textures(draw.material), frame.lightmap);
    return programs_.get(variant.key(), [&]() -> gl::Program::Desc {
        return {.vertex = "gl/scene.vert",
                .fragment = "gl/scene.frag",
                .definitions = variant.definitions(),
                .name = "scene"};
    });
}

void SceneRenderer::resize(uint32_t width, uint32_t height) {
    if (picture_.get() != 0 && picture_.width() == width && picture_.height() == height) return;
    multisampled_ = {}; // before the new ones take their memory
    picture_ = {};
    constexpr GLenum kDepth = GL_DEPTH_COMPONENT32F;
    if (samples_ > 0)
        multisampled_ = gl::Framebuffer(
            {.width = width, .height = height, .depth = kDepth, .samples = samples_, .name = "samples"});
    picture_ = gl::Framebuffer(
        {.width = width, .height = height, .depth = samples_ > 0 ? 0 : kDepth, .name = "picture"});
}

// Sets what shaders/gl/light.glsl asks for.
void SceneRenderer::setDisplay(const gl::Program& program, const Pass& pass) {
    program.set(kMeterScale, pass.meterScale);
    program.set(kExposure, std::exp2(pass.exposure));
    program.set(kDither, pass.dither);
}

void SceneRenderer::setUniforms(const gl::Program& program, const Frame& frame, const Pass& pass) const {
    program.set(kViewProjection, pass.viewProjection);
    program.set(kEye, frame.camera.eye);
    program.set(kAmbient, frame.lightmap.ambient);
    program.set(kLightmapSize, static_cast<GLuint>(frame.lightmap.size));
    program.set(kMedianDensity, frame.scene.medianDensity() * static_cast<float>(frame.lightmap.size));
    setDisplay(program, pass);
    program.set(kUnit, frame.lightmap.unit);
    program.set(kRangeLow, frame.settings.rangeLow);
    program.set(kRangeHigh, frame.settings.rangeHigh);
}

void SceneRenderer::drawScene(const Frame& frame, const Pass& pass) {
    std::vector<const SceneDraw*> visible = visibleDraws(frame.scene, pass.viewProjection, frame.camera.eye);
    counts_.drawn = static_cast<uint32_t>(visible.size());
    counts_.culled = static_cast<uint32_t>(frame.scene.draws().size()) - counts_.drawn;
    std::erase_if(visible, [](const SceneDraw* draw) { return draw->pane; });
    drawAll(frame, pass, visible);
}

// Draws the panes over what is behind them, the farthest first, so that all of them show. They hide nothing,
// and what the meter reads of the light stays.
void SceneRenderer::drawPanes(const Frame& frame, const Pass& pass) {
    if (frame.scene.draws().empty() || !frame.scene.draws().back().pane) return; // they are the last ones
    std::vector<const SceneDraw*> visible = visibleDraws(frame.scene, pass.viewProjection, frame.camera.eye);
    std::erase_if(visible, [](const SceneDraw* draw) { return !draw->pane; });
    std::reverse(visible.begin(), visible.end());
    glEnable(GL_BLEND);
    glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ZERO, GL_ONE);
    glDepthMask(GL_FALSE);
    drawAll(frame, pass, visible);
    glDepthMask(GL_TRUE);
    glDisable(GL_BLEND);
}

void SceneRenderer::drawAll(const Frame& frame, const Pass& pass,
                            const std::vector<const SceneDraw*>& draws) {
    bindScene(frame.scene);
    glBindTextureUnit(kLightmapUnit, frame.lightmap.texture);
    std::vector<const gl::Program*> ready; // have this frame's uniforms
    for (const SceneDraw* draw : draws) {
        const gl::Program& program = sceneProgram(frame, *draw);
        if (std::find(ready.begin(), ready.end(), &program) == ready.end()) {
            ready.push_back(&program);
            setUniforms(program, frame, pass);
        }
        const SceneGpu::MaterialTextures& textures = frame.scene.textures(draw->material);
        program.set(kMaterial, static_cast<GLuint>(draw->material));
        glBindTextureUnit(0, textures.base);
        glBindTextureUnit(1, textures.emission);
        glBindTextureUnit(2, textures.metallic);
        issue(frame.scene, program, *draw);
    }
}

// Draws the sky behind everything, where the depth is still what it was cleared to.
void SceneRenderer::drawSky(const Frame& frame, const Pass& pass) {
    const SkySettings& sky = frame.scene.sky();
    if (frame.settings.view != View::Lit || sky.radiance == glm::vec3(0.0f)) return;
    const GLuint picture = frame.scene.skyPicture();
    const auto tone = static_cast<uint32_t>(frame.settings.tone);
    const gl::Program& program =
        programs_.get(kSkyProgram | tone << 1 | (picture != 0 ? 1u : 0u), [&]() -> gl::Program::Desc {
            return {.vertex = "gl/screen.vert",
                    .fragment = "gl/sky.frag",
                    .definitions = {"PICTURE=" + std::to_string(picture != 0 ? 1 : 0),
                                    "TONE=" + std::to_string(tone) + "u"},
                    .name = "sky"};
        });
    const ViewCamera& camera = frame.camera;
    const glm::vec2 size(surface().width(), surface().height());
    const float above = camera.halfHeight > 0.0f ? 0.0f : std::tan(0.5f * camera.yfov);
    program.set(kSkyAhead, forward(camera));
    program.set(kSkyAcross, above * size.x / size.y * right(camera));
    program.set(kSkyAbove, above * glm::cross(right(camera), forward(camera)));
    program.set(kSkySize, size);
    program.set(kSkyRadiance, sky.radiance);
    program.set(kSkyRotation, sky.rotation);
    setDisplay(program, pass);
    program.use();
    glBindTextureUnit(0, picture);
    glBindVertexArray(empty_.get());
    glDisable(GL_CULL_FACE);
    glDepthFunc(GL_GEQUAL);
    glDepthMask(GL_FALSE);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glDepthMask(GL_TRUE);
    glDepthFunc(GL_GREATER);
}

void SceneRenderer::drawVoxels(const Frame& frame, const Pass& pass) {
    const gl::Program& program = programs_.get(kVoxelProgram, []() -> gl::Program::Desc {
        return {.vertex = "gl/voxel.vert", .fragment = "gl/voxel.frag", .definitions = {}, .name = "voxels"};
    });
    const VoxelDraw& voxels = *frame.voxels;
    const bool orthographic = frame.camera.halfHeight > 0.0f;
    const glm::vec4 eye =
        orthographic ? glm::vec4(-forward(frame.camera), 0.0f) : glm::vec4(frame.camera.eye, 1.0f);
    program.set(kViewProjection, pass.viewProjection);
    program.set(kVoxelEdge, voxels.edge());
    program.set(kVoxelColored, static_cast<GLuint>(voxels.colored() ? 1 : 0));
    program.set(kVoxelEye, eye);
    program.use();
    counts_ = {};
    if (voxels.count() == 0) return;
    constexpr GLsizei kCorners = 18; // of three faces
    glEnable(GL_CULL_FACE);
    glBindVertexArray(empty_.get());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, voxels.voxels().get());
    glDrawArraysInstanced(GL_TRIANGLES, 0, kCorners, static_cast<GLsizei>(voxels.count()));
}

void SceneRenderer::drawLines(const Frame& frame, const Pass& pass) {
    if (frame.lines->vertexCount() == 0) return;
    const gl::Program& program = programs_.get(kLineProgram, []() -> gl::Program::Desc {
        return {.vertex = "gl/line.vert", .fragment = "gl/line.frag", .definitions = {}, .name = "lines"};
    });
    constexpr float kHidden = 0.2f; // opacity of what surfaces hide
    program.set(kViewProjection, pass.viewProjection);
    program.use();
    glBindVertexArray(frame.lines->vertexArray().get());
    glEnable(GL_BLEND);
    glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ZERO, GL_ONE); // the meter's alpha stays
    glDepthMask(GL_FALSE);
    for (const bool hidden : {true, false}) {
        program.set(kLineOpacity, hidden ? kHidden : 1.0f);
        glDepthFunc(hidden ? GL_LEQUAL : GL_GREATER);
        glDrawArrays(GL_LINES, 0, static_cast<GLsizei>(frame.lines->vertexCount()));
    }
    glDepthFunc(GL_GREATER);
    glDepthMask(GL_TRUE);
    glDisable(GL_BLEND);
}

void SceneRenderer::drawBalls(const Frame& frame, const Pass& pass) {
    const View view = frame.settings.view;
    if (frame.balls->count() == 0 || (view != View::Lit && view != View::Lighting)) return;
    const auto tone = static_cast<uint32_t>(frame.settings.tone);
    const bool lighting = view == View::Lighting;
    const gl::Program& program =
        programs_.get(kBallProgram | tone << 1 | (lighting ? 1u : 0u), [&]() -> gl::Program::Desc {
            return {.vertex = "gl/ball.vert",
                    .fragment = "gl/ball.frag",
                    .definitions = {"LIGHTING=" + std::to_string(lighting ? 1 : 0),
                                    "TONE=" + std::to_string(tone) + "u"},
                    .name = "balls"};
        });
    const bool orthographic = frame.camera.halfHeight > 0.0f;
    program.set(kViewProjection, pass.viewProjection);
    program.set(kBallEye,
                orthographic ? glm::vec4(-forward(frame.camera), 0.0f) : glm::vec4(frame.camera.eye, 1.0f));
    setDisplay(program, pass);
    program.use();
    constexpr GLsizei kSquare = 6;
    glDisable(GL_CULL_FACE);
    glBindVertexArray(empty_.get());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, frame.balls->balls().get());
    glDrawArraysInstanced(GL_TRIANGLES, 0, kSquare, static_cast<GLsizei>(frame.balls->count()));
}

void SceneRenderer::render(const Frame& frame, float exposure) {
    const gl::Timer::Scope scope(timer_, "scene");
    const float aspect = static_cast<float>(picture_.width()) / static_cast<float>(picture_.height());
    const Pass pass{.viewProjection = projectionMatrix(frame.camera, aspect) * viewMatrix(frame.camera),
                    .meterScale = meterScaleOf(frame.lightmap),
                    .exposure = exposure,
                    .dither = frame.settings.dither ? 1.0f : 0.0f};
    beginScene(surface());
    clear(surface(), frame.settings.background);
    if (frame.voxels != nullptr)
        drawVoxels(frame, pass);
    else
        drawScene(frame, pass);
    if (frame.voxels == nullptr) {
        if (frame.balls != nullptr) drawBalls(frame, pass);
        drawSky(frame, pass);
        drawPanes(frame, pass);
    }
    if (frame.lines != nullptr) drawLines(frame, pass);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
}

void SceneRenderer::resolve() {
    if (samples_ == 0) return;
    const gl::Timer::Scope scope(timer_, "resolve");
    const auto width = static_cast<GLint>(picture_.width()), height = static_cast<GLint>(picture_.height());
    glBlitNamedFramebuffer(multisampled_.get(), picture_.get(), 0, 0, width, height, 0, 0, width, height,
                           GL_COLOR_BUFFER_BIT, GL_NEAREST);
}

float SceneRenderer::exposureFor(const Frame& frame) const {
    if (frame.settings.exposure) return *frame.settings.exposure;
    if (!measured_) return guessExposure(frame.lightmap);
    const float light = shader::luminance(frame.lightmap.ambient);
    const float stops = measuredLight_ ? std::log2(light / *measuredLight_) : 0.0f;
    if (std::isfinite(stops) && std::abs(stops) > kOtherLight) return *measured_ - stops;
    // A difference too small to be seen is no reason to draw again.
    return std::abs(*measured_ - exposure_) < kSameExposure ? exposure_ : *measured_;
}

SceneRenderer::Shown SceneRenderer::describe(const Frame& frame, const Target& target) const {
    return {.scene = frame.scene.version(),
            .lines = frame.lines != nullptr ? frame.lines->version() : 0,
            .voxels = frame.voxels != nullptr ? frame.voxels->version() : 0,
            .balls = frame.balls != nullptr ? frame.balls->version() : 0,
            .lightmap = frame.lightmap,
            .camera = frame.camera,
            .settings = frame.settings,
            .width = target.width,
            .height = target.height,
            .exposure = showsLight(frame.settings.view) ? exposureFor(frame) : 0.0f};
}

void SceneRenderer::takeMeasurement(bool wait) {
    const std::optional<float> result = meter_.result(wait);
    if (!result) return;
    measured_ = result;
    measuredLight_ = pendingLight_;
}

void SceneRenderer::measure(const Frame& frame) {
    // A measurement that was asked for before must arrive, or a device that is behind would never be
    // measured.
    unmeasured_ = meter_.pending();
    if (unmeasured_) return;
    const gl::Timer::Scope scope(timer_, "meter");
    meter_.measure(surface(), samples_, meterScaleOf(frame.lightmap));
    pendingLight_ = shader::luminance(frame.lightmap.ambient);
}

bool SceneRenderer::draw(const Frame& frame, const Target& target) {
    const bool automatic = showsLight(frame.settings.view) && !frame.settings.exposure && !frame.voxels;
    takeMeasurement(false);
    Shown wanted = describe(frame, target);
    const bool same = shown_ == wanted && frame.lightmap.version != 0;
    if (!same) {
        shown_.reset(); // none where the rest fails
        resize(target.width, target.height);
        render(frame, wanted.exposure);
        unmeasured_ = automatic;
        if (automatic) measure(frame);
        if (automatic && metering_ == Metering::Wait) {
            takeMeasurement(true);
            wanted.exposure = *measured_;
            render(frame, wanted.exposure);
        }
        resolve();
        if (showsLight(frame.settings.view)) exposure_ = wanted.exposure;
        shown_ = wanted;
    } else if (automatic && unmeasured_) {
        measure(frame);
    }
    present(target);
    return !same;
}

void SceneRenderer::present(const Target& target) {
    if (picture_.get() == 0) return;
    const gl::Timer::Scope scope(timer_, "present");
    const bool sameSize = picture_.width() == target.width && picture_.height() == target.height;
    glDisable(GL_SCISSOR_TEST);
    glBlitNamedFramebuffer(picture_.get(), target.framebuffer, 0, 0, static_cast<GLint>(picture_.width()),
                           static_cast<GLint>(picture_.height()), 0, 0, static_cast<GLint>(target.width),
                           static_cast<GLint>(target.height), GL_COLOR_BUFFER_BIT,
                           sameSize ? GL_NEAREST : GL_LINEAR);
    glBindFramebuffer(GL_FRAMEBUFFER, target.framebuffer);
}

bool SceneRenderer::adapting() const {
    if (!shown_ || shown_->settings.exposure || !showsLight(shown_->settings.view)) return false;
    return meter_.pending() || unmeasured_ ||
           (measured_ && std::abs(*measured_ - exposure_) >= kSameExposure);
}

} // namespace relume
