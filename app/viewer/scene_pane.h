#pragma once

#include <memory>

#include "app/live/session.h"
#include "app/viewer/view_state.h"
#include "renderer/scene_renderer.h"

namespace relume {

/// The picture of the scene: drawn when something of it changed, shown as often as one likes.
class ScenePane {
public:
    ScenePane() = default;

    /// nullptr: none. The scene is not read afterwards.
    void setScene(const LoadedScene* scene);
    bool hasScene() const { return gpu_ != nullptr; }
    void setMaterials(const std::vector<Material>& materials);

    struct Look {
        const ViewCamera& camera;
        const ViewState& state;
        LightmapTexture lightmap;
        const PublishedMap* map = nullptr; // that lightmap holds
    };
    void draw(const Look& look, glm::uvec2 size);
    /// Copies the last picture into the window's framebuffer, its lower left corner at `corner` [pixels].
    void show(glm::uvec2 corner) const;
    const gl::Framebuffer& picture() const { return picture_; }
    float exposure() const { return renderer_ ? renderer_->exposure() : 0.0f; }
    SceneRenderer::Counts counts() const { return renderer_ ? renderer_->counts() : SceneRenderer::Counts{}; }
    /// Compiles the shaders anew. Throws Error and keeps the old ones when one does not compile.
    void reload();

private:
    DrawSettings settingsOf(const Look& look);

    std::unique_ptr<SceneRenderer> renderer_; // with so many samples as were asked for
    uint32_t samples_ = 0;
    std::unique_ptr<SceneGpu> gpu_;
    gl::Framebuffer picture_;
    size_t shownView_ = 0; // of viewEntries(): the newest whose content was there
};

} // namespace relume
