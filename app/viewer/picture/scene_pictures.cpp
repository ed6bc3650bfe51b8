#include "app/viewer/picture/scene_pictures.h"

#include "assets/base/log.h"
#include "assets/images/image_file.h"

#include <chrono>
#include <exception>
#include <filesystem>
#include <system_error>

namespace relume {
namespace {

constexpr uint64_t kMostPicturePixels = 1u << 20; // far more than a tile shows

} // namespace

ScenePictures::~ScenePictures() {
    if (read_.valid()) read_.wait();
}

std::vector<ScenePictures::Pixels> ScenePictures::readAll(const std::vector<std::string>& files) {
    std::vector<Pixels> pictures;
    std::error_code code;
    for (const std::string& file : files) {
        if (!std::filesystem::exists(file, code)) continue;
        try {
            const FloatImage image = readImage(file, kMostPicturePixels);
            pictures.push_back({file, image.width, image.height, encodeSrgb(image, file)});
        } catch (const std::exception& error) {
            spdlog::warn("{}", error.what());
        }
    }
    return pictures;
}

void ScenePictures::read(const std::vector<std::string>& files) {
    if (begun_) return;
    begun_ = true;
    read_ = std::async(std::launch::async, [files] { return readAll(files); });
}

bool ScenePictures::follow() {
    if (!read_.valid() || read_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return false;
    for (const Pixels& pixels : read_.get()) {
        gl::Texture texture(
            {.width = pixels.width, .height = pixels.height, .mips = 0, .name = "scene picture"});
        texture.upload(GL_RGB, GL_UNSIGNED_BYTE, pixels.bytes.data());
        texture.generateMips();
        textures_[pixels.file] = std::move(texture);
    }
    return true;
}

uint32_t ScenePictures::texture(const std::string& file) const {
    const auto found = textures_.find(file);
    return found == textures_.end() ? 0 : found->second.get();
}

} // namespace relume
