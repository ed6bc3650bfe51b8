#include "renderer/tile_ids.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace relume {
namespace {

// The picture is so wide [pixels]; a tile that covers none of them is too small in it to come first.
constexpr uint32_t kWidth = 256;
constexpr uint32_t kMostHeight = 1024; // of windows that are narrow and high

} // namespace

void TileIds::resize(uint32_t height) {
    if (picture_.get() != 0 && picture_.height() == height) return;
    readback_ = {};
    picture_ = gl::Framebuffer({.width = kWidth,
                                .height = height,
                                .color = GL_R32UI,
                                .depth = GL_DEPTH_COMPONENT32F,
                                .name = "tiles"});
    readback_ = gl::Readback({.size = sizeof(uint32_t) * kWidth * height, .name = "tiles"});
}

void TileIds::request(const SceneGpu& scene, const ViewCamera& camera, float aspect, uint32_t lightmapSize) {
    const float wanted = static_cast<float>(kWidth) / std::max(aspect, 1e-3f);
    resize(std::clamp(static_cast<uint32_t>(std::lround(std::min(wanted, 1e6f))), 1u, kMostHeight));
    pass_.draw({.scene = scene,
                .viewProjection = projectionMatrix(camera, aspect) * viewMatrix(camera),
                .eye = camera.eye,
                .lightmapSize = lightmapSize},
               IdPass::Output::Tile, picture_);
    readback_.request(picture_, GL_RED_INTEGER, GL_UNSIGNED_INT);
}

std::optional<std::vector<uint32_t>> TileIds::poll() {
    const auto bytes = readback_.poll();
    if (!bytes) return std::nullopt;
    std::vector<uint32_t> tiles(bytes->size() / sizeof(uint32_t));
    std::memcpy(tiles.data(), bytes->data(), bytes->size());
    // Neighbouring pixels mostly see the same tile.
    tiles.erase(std::unique(tiles.begin(), tiles.end()), tiles.end());
    std::sort(tiles.begin(), tiles.end());
    tiles.erase(std::unique(tiles.begin(), tiles.end()), tiles.end());
    if (!tiles.empty() && tiles.front() == 0) tiles.erase(tiles.begin());
    for (uint32_t& tile : tiles)
        --tile;
    return tiles;
}

} // namespace relume
