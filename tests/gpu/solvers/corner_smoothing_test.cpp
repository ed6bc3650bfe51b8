// Light beside an edge of a room is smoothed along the edge, and not across it, nor through walls.
#include "tests/gpu/bake_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace relume {
namespace {

constexpr uint32_t kCornerMapSize = 96, kWallTexels = 24;
constexpr uint32_t kShedMapSize = 112, kShedFloorTexels = 36;
constexpr float kShedLow = 1.02f, kShedSize = 1.0f; // within its walls [m]

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

// Adds a box without a bottom that stands upright, z up; it is seen from within or from outside.
void addShell(SceneMaker& maker, glm::vec3 corner, glm::vec3 edges, int material, bool inside) {
    const auto side = [&](glm::vec3 from, glm::vec3 u, glm::vec3 v) {
        maker.quad(from, inside ? v : u, inside ? u : v, material, {4, 4});
    };
    const glm::vec3 x = edges.x * kX, y = edges.y * kY, z = edges.z * kZ;
    side(corner, z, y);
    side(corner + x, y, z);
    side(corner, x, z);
    side(corner + y, z, x);
    side(corner + z, x, y);
}

// A crate stands in the middle of a room's floor, below a lamp, on edges of texels.
ClosedRoom roomWithCrate() {
    SceneMaker maker(kShedMapSize);
    const int grey = maker.material(0.6f), lamp = maker.material(0.0f, 40.0f);
    const std::array<TexelRect, 6> walls =
        maker.box({0, 0, 0}, {3.0f * kX, 3.0f * kY, 3.0f * kZ}, grey, kShedFloorTexels);
    maker.quad({1, 1, 2.9f}, 1.0f * kY, 1.0f * kX, lamp, {2, 2});
    addShell(maker, {1, 1, 0}, {1, 1, 0.4f}, grey, false);
    return {maker.scene(), walls};
}

// Returns the light of a floor with that crate, by the distance from its foot to the wall [texels]: the mean
// over its four sides, without their ends.
std::vector<double> profileBesideCrate(const FloatImage& map, const TexelRect& floor) {
    constexpr uint32_t kFoot = kShedFloorTexels / 3, kEnds = 3, kLast = kShedFloorTexels - 1;
    std::vector<double> profile(kFoot, 0.0);
    for (uint32_t at = 0; at < kFoot; ++at)
        for (uint32_t along = kFoot + kEnds; along < 2 * kFoot - kEnds; ++along) {
            const uint32_t near = kFoot - 1 - at, far = kLast - near;
            profile[at] += texel(map, floor, near, along) + texel(map, floor, far, along) +
                           texel(map, floor, along, near) + texel(map, floor, along, far);
        }
    for (double& light : profile)
        light /= 4 * (kFoot - 2 * kEnds);
    return profile;
}

// A dark shed without a floor of its own stands on the floor of that room. Its walls go through the floor.
ClosedRoom roomWithShed(float thickness) {
    SceneMaker maker(kShedMapSize);
    const int grey = maker.material(0.6f), lamp = maker.material(0.0f, 40.0f);
    const std::array<TexelRect, 6> walls =
        maker.box({0, 0, 0}, {3.0f * kX, 3.0f * kY, 3.0f * kZ}, grey, kShedFloorTexels);
    maker.quad({1, 2, 2.9f}, 1.0f * kY, 1.0f * kX, lamp, {2, 2});
    const glm::vec3 low = glm::vec3(kShedLow, kShedLow, -0.1f), size(kShedSize, kShedSize, 1.3f);
    addShell(maker, low, size, grey, true);
    addShell(maker, low - glm::vec3(thickness, thickness, 0), size + glm::vec3(2, 2, 1) * thickness, grey,
             false);
    return {maker.scene(), walls};
}

} // namespace

// No light comes into the shed, so whatever is told of its floor has leaked. Its walls are thicker than a
// texel. Texels that they stand in and the next ones are left out: a part of the former lies outside.
TEST(CornerSmoothing, StopsAtAWallThatStandsOnTheSameFloor) {
    const ClosedRoom closed = roomWithShed(0.1f);
    const Baked baked = bakeScene(
        closed.scene,
        {.size = kShedMapSize, .passes = 0, .method = Method::Hybrid, .samples = 16, .smooth = true});
    const double outside = texel(baked.lighting, closed.walls[2], 4, kShedFloorTexels / 2);
    EXPECT_GT(outside, 0.5);
    const double texelSize = 3.0 / kShedFloorTexels;
    const auto first = static_cast<uint32_t>(std::ceil(kShedLow / texelSize)) + 1;
    const auto end = static_cast<uint32_t>((kShedLow + kShedSize) / texelSize) - 1;
    double most = 0;
    for (uint32_t row = first; row < end; ++row)
        for (uint32_t column = first; column < end; ++column)
            most = std::max(most, texel(baked.lighting, closed.walls[2], column, row));
    EXPECT_LT(most, 0.02 * outside) << outside;
}

// The crate is lit from above, so that the floor beside it has the lamp's penumbra and, of what comes from
// the walls, the less the nearer it is to the crate. Sixty-four directions are smoothed over some texels.
TEST(CornerSmoothing, LeavesTheShadowAtTheFootOfACrateSharp) {
    const ClosedRoom room = roomWithCrate();
    const auto bake = [&](uint32_t samples, bool smooth) {
        const Baked baked = bakeScene(room.scene, {.size = kShedMapSize,
                                                   .passes = 0,
                                                   .method = Method::Hybrid,
                                                   .samples = samples,
                                                   .smooth = smooth});
        return profileBesideCrate(baked.lighting, room.walls[2]);
    };
    const std::vector<double> truth = bake(4096, false), raw = bake(64, false), smoothed = bake(64, true);
    EXPECT_LT(truth.front(), 0.8 * truth[4]) << "there is a shadow";
    for (size_t at = 0; at < truth.size(); ++at) {
        EXPECT_NEAR(smoothed[at] / truth[at], 1.0, 0.02) << at << " texels off, unsmoothed " << raw[at];
    }
}

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
