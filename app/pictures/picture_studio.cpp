#include "app/pictures/picture_studio.h"

#include "app/offline/solve.h"
#include "assets/base/log.h"
#include "renderer/gl/debug.h"
#include "renderer/picture.h"

namespace relume {

PictureStudio::PictureStudio(const BakeOptions& options) : context_({.debug = options.machine.validate}) {
    spdlog::info("pictures: {}, by EGL ({})", gl::describeContext(), context_.platform());
}

void PictureStudio::open(const ShotOptions& options, const ShotRequest& request,
                         const PreparedScene& prepared) {
    const float aspect = static_cast<float>(request.width) / static_cast<float>(request.height);
    camera_ = chooseCamera(options, prepared.scene, prepared.mesh, aspect);
    scene_ = std::make_unique<SceneGpu>(prepared.scene, prepared.mesh);
    target_ = gl::Framebuffer({.width = request.width, .height = request.height, .name = "shot"});
}

FloatImage PictureStudio::take(const LightmapTexture& lightmap, const DrawSettings& settings) {
    renderer_.draw({.scene = *scene_, .lightmap = lightmap, .camera = camera_, .settings = settings},
                   {.framebuffer = target_.get(), .width = target_.width(), .height = target_.height()});
    return readPicture(target_);
}

PictureBake::PictureBake(const BakeOptions& options, const BakeRequest& request,
                         const PreparedScene& prepared)
    : device_(deviceDesc(options.machine)), size_(request.bake.size) {
    spdlog::info("device: {} ({})", device_.info().name, device_.info().driver);
    baker_ = std::make_unique<Baker>(device_, prepared.scene, prepared.mesh, request.bake);
    spdlog::info("{} patches", baker_->patches().count);
    warnIfDark(prepared.scene, baker_->patches());
}

void PictureBake::logEnd() {
    const SolverProgress& progress = baker_->solver().progress();
    spdlog::info("baked {} x {} in {:.2f} s, remaining error {:.2g}", size_, size_, progress.seconds,
                 progress.error);
}

} // namespace relume
