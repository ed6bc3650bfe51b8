#include "app/bench/quality/quality_pictures.h"

#include "assets/base/log.h"
#include "assets/images/flip.h"
#include "assets/images/image_file.h"
#include "assets/images/metrics.h"
#include "renderer/good_view.h"
#include "renderer/picture.h"

#include <filesystem>

namespace relume {
namespace {

constexpr uint32_t kWidth = 640, kHeight = 360; // of the pictures [pixels]
constexpr size_t kPictures = 3;

} // namespace

QualityPictures::QualityPictures(const PreparedScene& prepared)
    : prepared_(prepared), context_({}), scene_(prepared.scene, prepared.mesh),
      target_({.width = kWidth, .height = kHeight, .name = "quality"}) {}

FloatImage QualityPictures::draw(const FloatImage& lightmap, const ViewCamera& camera,
                                 std::optional<float> exposure) {
    const LightmapImage image(lightmap, "lightmap");
    DrawSettings settings;
    settings.tone = ToneMap::None;
    settings.exposure = exposure;
    renderer_.draw({.scene = scene_, .lightmap = image.texture(), .camera = camera, .settings = settings},
                   {.framebuffer = target_.get(), .width = kWidth, .height = kHeight});
    return readPicture(target_);
}

void QualityPictures::chooseCameras(const std::vector<LitPoint>& points) {
    const auto add = [&](const ViewCamera& camera, const std::string& name) {
        shots_.push_back({.camera = camera, .exposure = 0, .reference = {}});
        names_.push_back(name);
    };
    for (const Camera& camera : prepared_.scene.cameras)
        if (shots_.size() < kPictures) add(cameraOfFile(camera, scene_.bounds()), "camera " + camera.name);
    if (shots_.empty())
        add(goodView(prepared_.mesh, static_cast<float>(kWidth) / static_cast<float>(kHeight)), "start");
    for (const ViewCamera& camera : darkViews(LevelRays(prepared_.mesh), points, kPictures - shots_.size()))
        add(camera,
            fmt::format("dark place, from {:.2f} {:.2f} {:.2f} to {:.2f} {:.2f} {:.2f}", camera.eye.x,
                        camera.eye.y, camera.eye.z, camera.target.x, camera.target.y, camera.target.z));
}

void QualityPictures::begin(const FloatImage& reference, const std::vector<LitPoint>& points,
                            const std::string& folder) {
    folder_ = folder;
    if (!folder_.empty()) std::filesystem::create_directories(folder_);
    chooseCameras(points);
    for (size_t i = 0; i < shots_.size(); ++i) {
        shots_[i].reference = draw(reference, shots_[i].camera, {});
        shots_[i].exposure = renderer_.exposure();
        write(shots_[i].reference, "reference", i);
    }
}

std::vector<double> QualityPictures::compare(const FloatImage& lightmap, const std::string& name) {
    std::vector<double> flips;
    for (size_t i = 0; i < shots_.size(); ++i) {
        const FloatImage picture = draw(lightmap, shots_[i].camera, shots_[i].exposure);
        const ImagePair pair({picture, "picture"}, {shots_[i].reference, "reference"});
        flips.push_back(pair.mean(pair.flipDifferences(kFlipPixelsPerDegree)));
        if (!name.empty()) write(picture, name, i);
    }
    return flips;
}

void QualityPictures::write(const FloatImage& picture, const std::string& name, size_t index) const {
    if (!folder_.empty()) writeImage(fmt::format("{}/{}-{}.png", folder_, name, index + 1), picture);
}

} // namespace relume
