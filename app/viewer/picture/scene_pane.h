#pragma once

#include <map>
#include <memory>
#include <optional>

#include "app/live/session.h"
#include "app/viewer/state/view_state.h"
#include "renderer/overlays.h"
#include "renderer/picker.h"
#include "renderer/scene_renderer.h"
#include "renderer/surface_ids.h"
#include "renderer/tile_ids.h"
#include "renderer/uv_view.h"

namespace relume {

/// The picture of the scene. It is drawn when something of it changed, and shown as often as one likes. It
/// belongs to the current OpenGL context.
class ScenePane {
public:
    /// Makes an empty pane. `software` says that the CPU draws OpenGL and leaves out what costs it most.
    explicit ScenePane(bool software) : software_(software) {}
    bool software() const { return software_; }

    /// Sets the scene, which is not read afterwards; nullptr: none. Throws Error where OpenGL has no room for
    /// it: then there is none. So does setSkyPicture(), which leaves no picture then.
    void setScene(const LoadedScene* scene);
    bool hasScene() const { return gpu_ != nullptr; }
    void setMaterials(const std::vector<Material>& materials);
    void setSky(const SkySettings& sky);
    void setSkyPicture(const Sky& sky);
    std::string skyFile() const { return gpu_ ? gpu_->skyFile() : ""; }
    void setPlacements(const std::vector<Placement>& placements);
    /// Sets the links of a patch, which are drawn over the scene in the view of what it sees.
    void setPaths(const InspectPaths& paths);
    void setVoxels(const InspectVoxels& voxels);
    /// Sets balls in the scene, which views of light show; nullptr: none.
    void setBalls(std::unique_ptr<BallDraw> balls) { balls_ = std::move(balls); }
    /// Returns the box around all that is there.
    const Box& bounds() const { return bounds_; }

    struct Look {
        const ViewCamera& camera;
        const ViewState& state;
        LightmapTexture lightmap;
        const PublishedMap* map = nullptr; // what `lightmap` holds
    };
    /// Keeps a copy of the light that is shown, as the reference. Returns false where no light is shown.
    bool storeReference(const Look& look);
    bool hasReference() const { return reference_ != nullptr; }
    void draw(const Look& look, glm::uvec2 size);
    /// Copies the last picture into the window's framebuffer, its lower left corner at `corner` [pixels].
    void show(glm::uvec2 corner) const;
    const gl::Framebuffer& picture() const { return picture_; }
    /// Tells whether the last picture's automatic exposure is not settled: draw again soon.
    bool adapting() const { return light_ && renderer_ && renderer_->adapting(); }
    float exposure() const { return renderer_ ? renderer_->exposure() : 0.0f; }
    SceneRenderer::Counts counts() const { return renderer_ ? renderer_->counts() : SceneRenderer::Counts{}; }
    /// Ends a frame. Returns device and host times of the newest frame for which they are known; empty
    /// before.
    std::vector<gl::Timer::Pass> endFrame();

    /// Returns what is at a pixel of the last picture, counted from its upper left corner, or what is behind
    /// the instance `without`.
    std::optional<Pick> pick(const Look& look, glm::vec2 pixel, std::optional<uint32_t> without = {});
    /// Asks which tiles are seen; seenTiles() answers some frames later.
    void askTiles(const Look& look);
    bool tilesPending() const { return tiles_.pending(); }
    std::optional<std::vector<uint32_t>> seenTiles() { return tiles_.poll(); }

    /// Asks which surfaces are seen, for small pictures; surfaces() answers some frames later.
    void askSurfaces(const ViewCamera& camera);
    bool surfacesPending() const { return surfaces_.pending(); }
    std::optional<std::vector<SurfaceIds::Surface>> surfaces() { return surfaces_.poll(); }

    /// Compiles the shaders in use anew. Throws Error and keeps the old ones when one does not compile.
    void reload();

private:
    struct Reference {
        gl::Texture copy;
        LightmapTexture lightmap;
        bool radiance = false; // see PublishedMap::radiance
    };
    void drawReference(const Look& look, const DrawSettings& settings);
    DrawSettings settingsOf(const Look& look);
    void drawFlat(const Look& look, const DrawSettings& settings, const SceneRenderer::Target& target);
    void makeRenderer(uint32_t samples);
    void recallExposure();

    bool software_ = false;
    std::unique_ptr<SceneRenderer> renderer_; // made when there is first something to draw
    std::unique_ptr<UvView> flat_;
    TileIds tiles_;
    SurfaceIds surfaces_;
    std::unique_ptr<Picker> picker_;
    std::unique_ptr<SceneGpu> gpu_;
    Box bounds_;
    std::unique_ptr<LineDraw> lines_;
    std::unique_ptr<VoxelDraw> voxels_;
    std::unique_ptr<BallDraw> balls_;
    gl::Framebuffer picture_;
    std::unique_ptr<Reference> reference_;
    std::unique_ptr<SceneRenderer> referenceRenderer_; // keeps its own last picture
    gl::Framebuffer referencePicture_;
    std::map<size_t, float> exposures_; // what each view asked for when it was drawn last [EV]
    size_t drawnView_ = 0;              // of viewEntries(): in the last picture
    size_t shownView_ = 0;              // of viewEntries(): the newest whose content was there
    uint32_t samples_ = 0;
    bool light_ = false; // the last picture shows light of the scene
};

} // namespace relume
