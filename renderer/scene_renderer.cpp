#include "renderer/scene_renderer.h"

#include "renderer/exposure.h"
#include "renderer/frustum.h"
#include "renderer/gl/debug.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace relume {
namespace {

constexpr uint32_t kMeterCells =
    64; // along each side: few to read back, and the picture's parts are still told apart

// Uniforms, as the shaders number them.
constexpr GLint kViewProjection = 0, kMaterial = 1, kEye = 4, kAmbient = 5, kLightmapSize = 6, kPreScale = 7,
                kMedianDensity = 8, kHasLightmap = 9;
constexpr GLint kExposure = 0, kTone = 1, kLinear = 2, kBackground = 3;
constexpr GLuint kLightmapUnit = 3;

/// Names the commands issued while it exists, for captures and debug messages.
class Group {
public:
    explicit Group(const char* name) { glPushDebugGroup(GL_DEBUG_SOURCE_APPLICATION, 0, -1, name); }
    ~Group() { glPopDebugGroup(); }
    Group(const Group&) = delete;
    Group& operator=(const Group&) = delete;
};

// Brings the light of any unit near 1, so that half floats hold lamps and shadows alike.
float preScaleOf(const LightmapTexture& lightmap) {
    const float mean = shader::luminance(lightmap.ambient);
    return mean > 0.0f && std::isfinite(mean) ? 1.0f / mean : 1.0f;
}

void drawScreen(const gl::Program& program, const gl::VertexArray& screen) {
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    glDisable(GL_BLEND);
    program.use();
    glBindVertexArray(screen.get());
    glDrawArrays(GL_TRIANGLES, 0, 3);
}

} // namespace

SceneRenderer::SceneRenderer(uint32_t samples) : samples_(samples > 1 ? samples : 0) {
    gl::requireOpenGl45();
    GLint most = 0;
    glGetIntegerv(GL_MAX_COLOR_TEXTURE_SAMPLES, &most);
    samples_ = std::min(samples_, static_cast<uint32_t>(most));
    const std::string samplesText = "SAMPLES=" + std::to_string(samples_);
    const std::string cellsText = "kMeterCells=" + std::to_string(kMeterCells);
    sceneProgram({}); // what is wrong with it shows now
    meterProgram_ = gl::Program({.vertex = "gl/screen.vert",
                                 .fragment = "gl/meter.frag",
                                 .definitions = {samplesText, cellsText},
                                 .name = "meter"});
    displayProgram_ = gl::Program({.vertex = "gl/screen.vert",
                                   .fragment = "gl/display.frag",
                                   .definitions = {samplesText},
                                   .name = "display"});
    screen_ = gl::VertexArray({.attributes = {}, .name = "screen"});
    meter_ =
        gl::Framebuffer({.width = kMeterCells, .height = kMeterCells, .color = GL_RGBA32F, .name = "meter"});
}

const gl::Program& SceneRenderer::sceneProgram(const DrawSettings& settings) {
    gl::Program& program = scenePrograms_[{settings.view, settings.filter}];
    if (program.get() == 0) {
        const auto number = [](auto value) { return std::to_string(static_cast<uint32_t>(value)) + "u"; };
        program = gl::Program(
            {.vertex = "gl/scene.vert",
             .fragment = "gl/scene.frag",
             .definitions = {"VIEW=" + number(settings.view), "FILTER=" + number(settings.filter)},
             .name = "scene"});
    }
    return program;
}

void SceneRenderer::resize(const Target& target) {
    if (picture_.get() != 0 && picture_.width() == target.width && picture_.height() == target.height) return;
    picture_ = {}; // before the new one takes its memory
    picture_ = gl::Framebuffer({.width = target.width,
                                .height = target.height,
                                .color = GL_RGBA16F,
                                .depth = GL_DEPTH_COMPONENT32F,
                                .samples = samples_,
                                .name = "picture"});
}

void SceneRenderer::drawScene(const Frame& frame, float preScale) {
    const Group group("scene");
    const float aspect = static_cast<float>(picture_.width()) / static_cast<float>(picture_.height());
    const glm::mat4 viewProjection = projectionMatrix(frame.camera, aspect) * viewMatrix(frame.camera);
    glBindFramebuffer(GL_FRAMEBUFFER, picture_.get());
    glViewport(0, 0, static_cast<GLsizei>(picture_.width()), static_cast<GLsizei>(picture_.height()));
    glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_GREATER);
    glDepthMask(GL_TRUE);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glDisable(GL_BLEND);
    glDisable(GL_SCISSOR_TEST);
    glFrontFace(GL_CCW);
    glCullFace(GL_BACK);
    const std::array<float, 4> nothing = {0, 0, 0, 0};
    const float farAway = 0;
    glClearNamedFramebufferfv(picture_.get(), GL_COLOR, 0, nothing.data());
    glClearNamedFramebufferfv(picture_.get(), GL_DEPTH, 0, &farAway);

    const gl::Program& program = sceneProgram(frame.settings);
    const auto size = static_cast<float>(frame.lightmap.size);
    program.set(kViewProjection, viewProjection);
    program.set(kEye, frame.camera.eye);
    program.set(kAmbient, frame.lightmap.ambient);
    program.set(kLightmapSize, static_cast<GLuint>(frame.lightmap.size));
    program.set(kHasLightmap, static_cast<GLuint>(frame.lightmap.texture != 0 ? 1 : 0));
    program.set(kPreScale, preScale);
    program.set(kMedianDensity, frame.scene.medianDensity() * size);
    program.use();
    glBindVertexArray(frame.scene.vertexArray().get());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, frame.scene.materials().get());
    glBindTextureUnit(kLightmapUnit, frame.lightmap.texture);

    const Frustum frustum(viewProjection);
    counts_ = {};
    uint32_t material = 0xffffffffu;
    for (const SceneDraw& draw : frame.scene.draws()) {
        if (!frustum.sees(draw.bounds)) {
            ++counts_.culled;
            continue;
        }
        ++counts_.drawn;
        if (draw.material != material) {
            material = draw.material;
            const SceneGpu::MaterialTextures& textures = frame.scene.textures(material);
            program.set(kMaterial, static_cast<GLuint>(material));
            glBindTextureUnit(0, textures.base);
            glBindTextureUnit(1, textures.emission);
            glBindTextureUnit(2, textures.metallic);
        }
        if (draw.doubleSided)
            glDisable(GL_CULL_FACE);
        else
            glEnable(GL_CULL_FACE);
        glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(draw.indexCount), GL_UNSIGNED_INT,
                       reinterpret_cast<const void*>(sizeof(uint32_t) * size_t{draw.firstIndex}));
    }
}

float SceneRenderer::measureExposure(float preScale) {
    const Group group("meter");
    glBindFramebuffer(GL_FRAMEBUFFER, meter_.get());
    glViewport(0, 0, kMeterCells, kMeterCells);
    glBindTextureUnit(0, picture_.color().get());
    drawScreen(meterProgram_, screen_);
    std::vector<glm::vec4> cells(size_t{kMeterCells} * kMeterCells);
    glGetTextureImage(meter_.color().get(), 0, GL_RGBA, GL_FLOAT,
                      static_cast<GLsizei>(cells.size() * sizeof(glm::vec4)), cells.data());
    return automaticExposure(cells) + std::log2(preScale);
}

void SceneRenderer::draw(const Frame& frame, const Target& target) {
    resize(target);
    const bool linear = showsLight(frame.settings.view);
    const float preScale = linear ? preScaleOf(frame.lightmap) : 1.0f;
    drawScene(frame, preScale);
    if (linear) exposure_ = frame.settings.exposure ? *frame.settings.exposure : measureExposure(preScale);

    const Group group("display");
    glBindFramebuffer(GL_FRAMEBUFFER, target.framebuffer);
    glViewport(0, 0, static_cast<GLsizei>(target.width), static_cast<GLsizei>(target.height));
    glBindTextureUnit(0, picture_.color().get());
    displayProgram_.set(kExposure, std::exp2(exposure_) / preScale);
    displayProgram_.set(kTone, static_cast<GLuint>(frame.settings.tone));
    displayProgram_.set(kLinear, static_cast<GLuint>(linear ? 1 : 0));
    displayProgram_.set(kBackground, frame.settings.background);
    drawScreen(displayProgram_, screen_);
}

} // namespace relume
