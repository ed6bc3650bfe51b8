// These are closed rooms whose light is known everywhere, corners and edges included.
#include "tests/gpu/bake_scene.h"
#include "tests/unit/closed_forms.h"

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

#include <cmath>

namespace relume {
namespace {

/// Returns the edges of a box that lies askew in the world.
std::array<glm::vec3, 3> leaning(glm::vec3 size) {
    const glm::mat3 turn(glm::rotate(glm::mat4(1.0f), 0.7f, glm::normalize(glm::vec3(0.3f, 1.0f, -0.5f))));
    return {turn[0] * size.x, turn[1] * size.y, turn[2] * size.z};
}

template<typename Rects>
void expectEverywhere(const FloatImage& image, const Rects& rects, double exact, double tolerance) {
    for (size_t i = 0; i < rects.size(); ++i) {
        const TexelStatistics s = statistics(image, rects[i]);
        EXPECT_EQ(s.count, rects[i].width * rects[i].height) << "chart " << i;
        EXPECT_GT(s.min, exact * (1 - tolerance)) << "chart " << i << ", mean " << s.mean;
        EXPECT_LT(s.max, exact * (1 + tolerance)) << "chart " << i << ", mean " << s.mean;
    }
}

} // namespace

// What a patch receives from walls of radiance 1 all around is the sum of its row of form factors.
TEST(Furnace, RowsOfABoxSumToOne) {
    SceneMaker maker(100);
    const auto walls =
        maker.box({-1, -1, -1}, {glm::vec3(2, 0, 0), {0, 2, 0}, {0, 0, 2}}, maker.material(0.0f, 1.0f), 32);
    expectEverywhere(bakeScene(maker.scene(), {.size = maker.size()}).lighting, walls, 1.0, 0.005);
}

TEST(Furnace, RowsOfALeaningRoomSumToOne) {
    SceneMaker maker(128);
    const int lamp = maker.material(0.0f, 1.0f);
    const auto walls =
        maker.box({3, 1, -2}, leaning({1.5f, 1.0f, 2.0f}), {lamp, lamp, lamp, lamp, lamp, lamp},
                  {glm::uvec2(20, 40), {40, 30}, {30, 20}, {20, 40}, {40, 30}, {30, 20}});
    expectEverywhere(bakeScene(maker.scene(), {.size = maker.size()}).lighting, walls, 1.0, 0.005);
}

// Texels are twice as long as wide, with neighbours of other sizes around the corner, while the formula for
// far pairs is for squares.
TEST(Furnace, RowsWithUnlikeTexelsSumToOne) {
    SceneMaker maker(100);
    const int lamp = maker.material(0.0f, 1.0f);
    const auto walls = maker.box({0, 0, 0}, leaning({1, 1, 1}), {lamp, lamp, lamp, lamp, lamp, lamp},
                                 {glm::uvec2(32, 16), {32, 32}, {16, 32}, {16, 16}, {32, 16}, {32, 32}});
    expectEverywhere(bakeScene(maker.scene(), {.size = maker.size()}).lighting, walls, 1.0, 0.01);
}

class FurnaceOfAlbedo : public testing::TestWithParam<float> {};

TEST_P(FurnaceOfAlbedo, EndsAtTheSeriesLimit) {
    SceneMaker maker(64);
    const auto walls = maker.box({3, 1, -2}, leaning({2, 2, 2}), maker.material(GetParam(), 1.0f), 20);
    const Baked baked = bakeScene(maker.scene(), {.size = maker.size(), .passes = 0, .error = 1e-4});
    EXPECT_TRUE(baked.progress.converged);
    EXPECT_LE(baked.progress.error, 1e-4);
    expectEverywhere(baked.radiance, walls, 1.0 / (1.0 - GetParam()), 0.01);
}

INSTANTIATE_TEST_SUITE_P(Albedos, FurnaceOfAlbedo, testing::Values(0.25f, 0.5f, 0.8f));

// The error that the solver tells is the distance to the limit.
TEST(Furnace, RemainingErrorIsTold) {
    SceneMaker maker(40);
    const auto walls = maker.box({0, 0, 0}, leaning({1, 1, 1}), maker.material(0.8f, 1.0f), 12);
    const auto lighting = [&](uint32_t passes, double& told) {
        const Baked baked = bakeScene(maker.scene(), {.size = maker.size(), .passes = passes});
        told = baked.progress.error;
        return statistics(baked.lighting, walls[0]).mean;
    };
    double told = 0, none = 0;
    const double early = lighting(8, told), late = lighting(80, none);
    EXPECT_NEAR((late - early) / early, told, 0.1 * told);
}

// In the integrating sphere, what one part of it sends arrives everywhere alike, on itself too.
TEST(Furnace, SphereInteriorIsLitEvenly) {
    SceneMaker maker(112);
    const int black = maker.material(0.0f), lamp = maker.material(0.0f, 1.0f);
    const auto faces = maker.sphere({1, 2, 3}, 1.5f, {lamp, black, black, black, black, black}, 36);
    const double area = 4 * closed::kPi * 1.5 * 1.5 / 6;
    expectEverywhere(bakeScene(maker.scene(), {.size = maker.size()}).lighting, faces,
                     closed::sphereInterior(area, 1.5), 0.01);
}

// A wall stands on the middles of large texels, which lie inside it. What is seen of these beside the wall
// sends light by itself, where patches step aside, else as the patch next to it does: whatever rays meet is
// of one radiance.
TEST(Furnace, SeesTexelsWhoseMiddlesAreInsideAWall) {
    for (const TracerKind tracer : tracersOfTestDevice())
        for (const bool allOver : {true, false}) {
            SceneMaker maker(64);
            const int grey = maker.material(0.5f, 1.0f);
            const auto walls = maker.box({0, 0, 0}, {2.0f * kX, 2.0f * kY, 2.0f * kZ}, grey, 8);
            // It is thinner than a texel, and sunk into the floor.
            const glm::vec3 lo(0.32f, 0.3f, -0.1f), hi(0.44f, 1.7f, 1.2f), size = hi - lo;
            maker.quad(lo, size.z * kZ, size.y * kY, grey, glm::uvec2(6));
            maker.quad({hi.x, lo.y, lo.z}, size.y * kY, size.z * kZ, grey, glm::uvec2(6));
            maker.quad(lo, size.x * kX, size.z * kZ, grey, glm::uvec2(6));
            maker.quad({lo.x, hi.y, lo.z}, size.z * kZ, size.x * kX, grey, glm::uvec2(6));
            maker.quad({lo.x, lo.y, hi.z}, size.x * kX, size.y * kY, grey, glm::uvec2(6));
            BakeDesc desc{.size = maker.size(),
                          .tracer = tracer,
                          .passes = 40,
                          .method = Method::Directional,
                          .samples = 128};
            desc.allOver = allOver;
            const Baked baked = bakeScene(maker.scene(), desc);
            if (allOver)
                EXPECT_GE(baked.patches.aside.size(), 5u);
            else
                EXPECT_GE(baked.invalid, 5u);
            uint32_t count = 0;
            for (uint32_t i = 0; i < baked.patches.count; ++i) {
                const shader::Patch& p = baked.patches.scene.patches[i];
                if (!shader::patchIsShown(p.flags) || p.position.z < 0) continue;
                const uint32_t texel = shader::patchTexel(p.flags);
                EXPECT_NEAR(baked.radiance.planes[0][texel], 2.0f, 2e-3f)
                    << p.position.x << ", " << p.position.y << ", " << p.position.z;
                ++count;
            }
            EXPECT_GT(count, 500u);
            EXPECT_GT(statistics(baked.radiance, walls[2]).count, 50u);
        }
}

} // namespace relume
