#include "app/viewer/picture/scene_pane.h"

#include "app/viewer/state/views.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace relume {
namespace {

constexpr glm::vec3 kLinkColour(1.0f, 0.75f, 0.25f); // as displayed

} // namespace

void ScenePane::setScene(const LoadedScene* scene) {
    gpu_.reset(); // before the new one takes its memory
    lines_.reset();
    voxels_.reset();
    balls_.reset();
    exposures_.clear();
    reference_.reset();
    if (scene == nullptr) return;
    bounds_ = scene->geometry.bounds;
    gpu_ = std::make_unique<SceneGpu>(scene->prepared.scene, scene->geometry);
    if (software_) gpu_->setAnisotropy(1.0f);
}

void ScenePane::setMaterials(const std::vector<Material>& materials) {
    Scene factors;
    factors.materials = materials;
    if (gpu_) gpu_->updateMaterials(factors);
}

void ScenePane::setSky(const SkySettings& sky) {
    if (gpu_) gpu_->updateSky(sky);
}

void ScenePane::setSkyPicture(const Sky& sky) {
    if (gpu_) gpu_->updateSkyPicture(sky);
}

void ScenePane::askSurfaces(const ViewCamera& camera) {
    if (gpu_) surfaces_.request(*gpu_, camera);
}

void ScenePane::setPlacements(const std::vector<Placement>& placements) {
    if (!gpu_) return;
    gpu_->updatePlacements(placements);
    bounds_ = gpu_->bounds();
}

bool ScenePane::storeReference(const Look& look) {
    if (look.map == nullptr || look.map->content != MapContent::Light || look.lightmap.texture == 0)
        return false;
    const LightmapTexture& shown = look.lightmap;
    if (!reference_ || reference_->copy.width() != shown.size) {
        reference_.reset(); // before the new one takes its memory
        reference_ = std::make_unique<Reference>();
        reference_->copy = gl::Texture(
            {.width = shown.size, .height = shown.size, .format = GL_RGBA16F, .name = "reference lightmap"});
    }
    const auto edge = static_cast<GLsizei>(shown.size);
    glCopyImageSubData(shown.texture, GL_TEXTURE_2D, 0, 0, 0, 0, reference_->copy.get(), GL_TEXTURE_2D, 0, 0,
                       0, 0, edge, edge, 1);
    reference_->lightmap = shown;
    reference_->lightmap.texture = reference_->copy.get();
    reference_->lightmap.version = newVersion();
    reference_->radiance = look.map->radiance;
    return true;
}

// Draws the reference with the exposure of the other half, so that nothing but light differs.
void ScenePane::drawReference(const Look& look, const DrawSettings& settings) {
    const uint32_t width = picture_.width(), height = picture_.height();
    if (!referenceRenderer_)
        referenceRenderer_ = std::make_unique<SceneRenderer>(samples_, SceneRenderer::Metering::Async);
    referenceRenderer_->setSamples(samples_);
    if (referencePicture_.get() == 0 || referencePicture_.width() != width ||
        referencePicture_.height() != height) {
        referencePicture_ = {};
        referencePicture_ = gl::Framebuffer({.width = width, .height = height, .name = "reference picture"});
    }
    DrawSettings exposed = settings;
    exposed.exposure = renderer_->exposure();
    referenceRenderer_->draw(
        {.scene = *gpu_, .lightmap = reference_->lightmap, .camera = look.camera, .settings = exposed},
        {.framebuffer = referencePicture_.get(), .width = width, .height = height});
    const auto right = static_cast<GLint>(std::lround(look.state.wipeAt * static_cast<float>(width)));
    const auto top = static_cast<GLint>(height);
    glBlitNamedFramebuffer(referencePicture_.get(), picture_.get(), 0, 0, right, top, 0, 0, right, top,
                           GL_COLOR_BUFFER_BIT, GL_NEAREST);
}

void ScenePane::setPaths(const InspectPaths& paths) {
    std::vector<LineDraw::Segment> segments;
    for (const glm::vec3& end : paths.ends)
        segments.push_back({.from = paths.from, .to = end, .color = kLinkColour});
    lines_ = segments.empty() ? nullptr : std::make_unique<LineDraw>(segments);
}

void ScenePane::setVoxels(const InspectVoxels& voxels) {
    voxels_ = voxels.centres.empty() ? nullptr
                                     : std::make_unique<VoxelDraw>(VoxelDraw::Desc{
                                           .centres = voxels.centres, .edge = voxels.edge, .colors = {}});
}

void ScenePane::reload() {
    if (renderer_) renderer_->reload();
    if (referenceRenderer_) referenceRenderer_->reload();
    if (flat_) flat_->reload();
    if (picker_) picker_->reload();
    tiles_.reload();
    surfaces_.reload();
}

// Returns how to draw the look. The map may still hold what the view before needs.
DrawSettings ScenePane::settingsOf(const Look& look) {
    const ViewEntry& wanted = viewEntries()[look.state.view];
    const MapContent held = look.map != nullptr ? look.map->content : MapContent::Light;
    if (!wanted.readsMap || held == wanted.content) shownView_ = look.state.view;
    const ViewEntry* shown = &viewEntries()[shownView_];
    // The map is another scene's, or there is none: whatever was shown, only light can be drawn without it.
    if (shown->readsMap && shown->content != held) shown = &viewEntries()[viewIndex("lit")];
    DrawSettings settings{.view = shown->view,
                          .filter = look.state.filter,
                          .tone = look.state.tone,
                          .exposure = look.state.exposure,
                          .selected = look.state.selected};
    // RTRad's map already has the albedo in it.
    if (settings.view == View::Lit && look.map != nullptr && look.map->radiance)
        settings.view = View::Lighting;
    if (settings.view == View::InspectLeaves) settings.filter = LightmapFilter::Nearest; // they have edges
    const float unit = look.map != nullptr ? look.map->unit : 1.0f; // ranges are those of texels
    if (settings.view == View::InspectPosition) {
        settings.rangeLow = bounds_.low / unit;
        settings.rangeHigh = bounds_.high / unit;
    } else if (settings.view == View::InspectHeat && look.map != nullptr) {
        settings.rangeLow.x = std::min(look.map->low, 0.0f) / unit;
        settings.rangeHigh.x = look.state.high.value_or(std::max(look.map->high, 1e-12f)) / unit;
    }
    return settings;
}

void ScenePane::makeRenderer(uint32_t samples) {
    if (!renderer_) renderer_ = std::make_unique<SceneRenderer>(samples, SceneRenderer::Metering::Async);
    if (samples_ != samples) renderer_->setSamples(samples);
    samples_ = samples;
}

// Lets each view go on with its own exposure, because views of light differ in brightness.
void ScenePane::recallExposure() {
    if (light_ && !renderer_->adapting()) exposures_[drawnView_] = renderer_->exposure();
    if (drawnView_ == shownView_) return;
    drawnView_ = shownView_;
    const auto known = exposures_.find(drawnView_);
    if (known != exposures_.end()) renderer_->expectExposure(known->second);
}

void ScenePane::drawFlat(const Look& look, const DrawSettings& settings,
                         const SceneRenderer::Target& target) {
    if (!flat_) flat_ = std::make_unique<UvView>();
    DrawSettings exposed = settings;
    // It takes the exposure that the scene asked for last, so that nothing jumps between model and texture.
    if (!exposed.exposure) exposed.exposure = exposure();
    flat_->draw(look.lightmap, {.window = look.state.uvWindow, .masked = look.state.masked, .draw = exposed},
                target);
}

void ScenePane::draw(const Look& look, glm::uvec2 size) {
    if (picture_.get() == 0 || picture_.width() != size.x || picture_.height() != size.y) {
        picture_ = {};
        picture_ = gl::Framebuffer({.width = size.x, .height = size.y, .name = "scene picture"});
    }
    const DrawSettings settings = settingsOf(look);
    if (!gpu_) {
        light_ = false;
        const std::array<float, 4> background = {settings.background.r, settings.background.g,
                                                 settings.background.b, 1.0f};
        glClearNamedFramebufferfv(picture_.get(), GL_COLOR, 0, background.data());
        return;
    }
    const SceneRenderer::Target target{.framebuffer = picture_.get(), .width = size.x, .height = size.y};
    makeRenderer(look.state.samples);
    recallExposure();
    light_ = false;
    if (look.state.uv) return drawFlat(look, settings, target);
    const ViewEntry& wanted = viewEntries()[look.state.view];
    light_ = showsLight(settings.view);
    renderer_->draw({.scene = *gpu_,
                     .lightmap = look.lightmap,
                     .camera = look.camera,
                     .settings = settings,
                     .lines = settings.view == View::InspectMask ? lines_.get() : nullptr,
                     .voxels = wanted.voxels ? voxels_.get() : nullptr,
                     .balls = balls_.get()},
                    target);
    const bool same = reference_ && look.map != nullptr && reference_->radiance == look.map->radiance;
    if (look.state.wipe && same && light_ && readsLightmap(settings.view) &&
        wanted.content == MapContent::Light && !wanted.voxels)
        drawReference(look, settings);
}

void ScenePane::show(glm::uvec2 corner) const {
    if (picture_.get() == 0) return;
    const auto width = static_cast<GLint>(picture_.width()), height = static_cast<GLint>(picture_.height());
    const auto x = static_cast<GLint>(corner.x), y = static_cast<GLint>(corner.y);
    const GLuint window = 0;
    glBlitNamedFramebuffer(picture_.get(), window, 0, 0, width, height, x, y, x + width, y + height,
                           GL_COLOR_BUFFER_BIT, GL_NEAREST);
}

std::vector<gl::Timer::Pass> ScenePane::endFrame() {
    if (!renderer_) return {};
    renderer_->timer().endFrame();
    if (referenceRenderer_) referenceRenderer_->timer().endFrame();
    return renderer_->timer().passes();
}

std::optional<Pick> ScenePane::pick(const Look& look, glm::vec2 pixel, std::optional<uint32_t> without) {
    if (!gpu_ || picture_.get() == 0) return std::nullopt;
    const glm::vec2 size(picture_.width(), picture_.height());
    if (look.state.uv) {
        const glm::vec2 uv = uvAt(look.state.uvWindow, pixel, size);
        if (glm::any(glm::lessThan(uv, glm::vec2(0))) || glm::any(glm::greaterThanEqual(uv, glm::vec2(1))))
            return std::nullopt;
        Pick pick;
        pick.lightmapUv = uv;
        pick.texel = glm::uvec2(uv * static_cast<float>(look.lightmap.size));
        return pick;
    }
    if (!picker_) picker_ = std::make_unique<Picker>();
    return picker_->pick({.scene = *gpu_,
                          .camera = look.camera,
                          .pixel = pixel,
                          .size = size,
                          .lightmapSize = std::max(look.lightmap.size, 1u),
                          .without = without});
}

void ScenePane::askTiles(const Look& look) {
    if (!gpu_ || picture_.get() == 0 || look.lightmap.size == 0) return;
    const float aspect = static_cast<float>(picture_.width()) / static_cast<float>(picture_.height());
    tiles_.request(*gpu_, look.camera, aspect, look.lightmap.size);
}

} // namespace relume
