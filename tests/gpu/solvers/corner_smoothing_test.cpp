// Light beside an edge of a room is smoothed along the edge, and not across it.
#include "tests/gpu/bake_scene.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace relume {
namespace {

constexpr uint32_t kCornerMapSize = 96, kWallTexels = 24;

struct ClosedRoom {
    Scene scene;
    std::array<TexelRect, 6> walls;
};

// A closed room with a lamp below its ceiling.
ClosedRoom closedRoom() {
    SceneMaker maker(kCornerMapSize);
    const int grey = maker.material(0.6f), lamp = maker.material(0.0f, 40.0f);
    const std::array<TexelRect, 6> walls =
        maker.box({0, 0, 0}, {3.0f * kX, 3.0f * kY, 3.0f * kZ}, grey, kWallTexels);
    maker.quad({1, 2.9f, 1}, 1.0f * kX, 1.0f * kZ, lamp, {2, 2});
    return {maker.scene(), walls};
}

BakeDesc cornerBake(uint32_t samples, bool smooth) {
    return {
        .size = kCornerMapSize, .passes = 0, .method = Method::Hybrid, .samples = samples, .smooth = smooth};
}

// How far the rows or columns of texels at the walls' edges are off, relative to their light: as the root of
// the mean square, and in the mean. Their ends are left out, where a third wall is near.
struct EdgeOff {
    double noise = 0, bias = 0;
};
EdgeOff edgeOff(const FloatImage& map, const FloatImage& truth, const ClosedRoom& closed) {
    constexpr uint32_t kEnds = 4;
    double squares = 0, sum = 0;
    uint32_t count = 0;
    const auto add = [&](const TexelRect& wall, uint32_t column, uint32_t row) {
        const double right = texel(truth, wall, column, row);
        const double off = texel(map, wall, column, row) / right - 1.0;
        squares += off * off;
        sum += off;
        ++count;
    };
    for (const TexelRect& wall : closed.walls)
        for (uint32_t at = kEnds; at < kWallTexels - kEnds; ++at)
            for (const uint32_t side : {0u, kWallTexels - 1}) {
                add(wall, at, side);
                add(wall, side, at);
            }
    return {std::sqrt(squares / count), sum / count};
}

} // namespace

TEST(CornerSmoothing, GoesAlongEdgesAndNotAcross) {
    const ClosedRoom closed = closedRoom();
    const Baked truth = bakeScene(closed.scene, cornerBake(8192, false));
    const EdgeOff raw =
        edgeOff(bakeScene(closed.scene, cornerBake(16, false)).lighting, truth.lighting, closed);
    const EdgeOff smoothed =
        edgeOff(bakeScene(closed.scene, cornerBake(16, true)).lighting, truth.lighting, closed);
    // It is 0.53 of the unsmoothed noise; by one distance for both directions it would be 0.70.
    EXPECT_LT(smoothed.noise, 0.6 * raw.noise) << raw.noise;
    EXPECT_NEAR(smoothed.bias, raw.bias, 0.01);
}

} // namespace relume
