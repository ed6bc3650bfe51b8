#include "app/viewer/scene_pane.h"

#include "app/viewer/views.h"

#include <array>

namespace relume {

void ScenePane::setScene(const LoadedScene* scene) {
    gpu_.reset(); // before the new one takes its memory
    if (scene != nullptr) gpu_ = std::make_unique<SceneGpu>(scene->prepared.scene, scene->prepared.mesh);
}

void ScenePane::setMaterials(const std::vector<Material>& materials) {
    if (gpu_) gpu_->setMaterials(materials);
}

void ScenePane::reload() {
    auto fresh = std::make_unique<SceneRenderer>(samples_);
    renderer_ = std::move(fresh);
}

// What the map holds may still be of the view before.
DrawSettings ScenePane::settingsOf(const Look& look) {
    const ViewEntry& wanted = viewEntries()[look.state.view];
    const bool there = look.map == nullptr ? wanted.content == MapContent::Light
                                           : look.map->content == wanted.content;
    if (there || !wanted.readsMap) shownView_ = look.state.view;
    return {.view = viewEntries()[shownView_].view,
            .filter = look.state.filter,
            .tone = look.state.tone,
            .exposure = look.state.exposure};
}

void ScenePane::draw(const Look& look, glm::uvec2 size) {
    if (picture_.get() == 0 || picture_.width() != size.x || picture_.height() != size.y) {
        picture_ = {};
        picture_ = gl::Framebuffer({.width = size.x, .height = size.y, .name = "scene picture"});
    }
    const DrawSettings settings = settingsOf(look);
    if (!gpu_) {
        const std::array<float, 4> background = {settings.background.r, settings.background.g,
                                                 settings.background.b, 1.0f};
        glClearNamedFramebufferfv(picture_.get(), GL_COLOR, 0, background.data());
        return;
    }
    if (!renderer_ || samples_ != look.state.samples) {
        renderer_.reset();
        samples_ = look.state.samples;
        renderer_ = std::make_unique<SceneRenderer>(samples_);
    }
    renderer_->draw({.scene = *gpu_, .lightmap = look.lightmap, .camera = look.camera, .settings = settings},
                    {.framebuffer = picture_.get(), .width = size.x, .height = size.y});
}

void ScenePane::show(glm::uvec2 corner) const {
    if (picture_.get() == 0) return;
    const auto width = static_cast<GLint>(picture_.width()), height = static_cast<GLint>(picture_.height());
    const auto x = static_cast<GLint>(corner.x), y = static_cast<GLint>(corner.y);
    glDisable(GL_SCISSOR_TEST);
    const GLuint window = 0;
    glBlitNamedFramebuffer(picture_.get(), window, 0, 0, width, height, x, y, x + width, y + height,
                           GL_COLOR_BUFFER_BIT, GL_NEAREST);
}

} // namespace relume
