#pragma once

#include "app/pictures/shot_options.h"
#include "bake/baker/baker.h"
#include "renderer/gl/headless_context.h"
#include "renderer/scene_renderer.h"

#include <memory>

namespace relume {

/// Makes pictures of one scene without a display.
class PictureStudio {
public:
    /// Opens OpenGL, before a bake, which would be in vain where there is none. Throws Error.
    explicit PictureStudio(const BakeOptions& options);

    /// Takes the scene that the pictures show. Throws Error, also for a camera that it does not have.
    void open(const ShotOptions& options, const ShotRequest& request, const PreparedScene& prepared);
    /// Takes a picture in the size asked for. Throws Error.
    FloatImage take(const LightmapTexture& lightmap, const DrawSettings& settings);
    /// Returns where the picture is taken from, and moves it.
    const ViewCamera& camera() const { return camera_; }
    void setCamera(const ViewCamera& camera) { camera_ = camera; }
    float exposure() const { return renderer_.exposure(); } // of the last picture of light [EV]

private:
    gl::HeadlessContext context_;
    SceneRenderer renderer_;
    ViewCamera camera_;
    std::unique_ptr<SceneGpu> scene_;
    gl::Framebuffer target_;
};

/// A bake for pictures, not yet stepped. It logs what it uses and how many patches there are. It must be
/// destroyed after the studio: with NVIDIA's driver OpenGL finds its context no more once the process has let
/// go of Vulkan.
class PictureBake {
public:
    PictureBake(const BakeOptions& options, const BakeRequest& request, const PreparedScene& prepared);

    Baker& baker() { return *baker_; }
    /// Logs how the bake ended.
    void logEnd();

private:
    vk::Device device_;
    std::unique_ptr<Baker> baker_;
    uint32_t size_;
};

} // namespace relume
