// The light of places in a scene as the viewer shows it: a ball that is dragged, and a grid of light probes.
#include "app/live/light_balls.h"
#include "app/viewer/picture/probe_balls.h"
#include "tests/text.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace relume {
namespace {

constexpr glm::vec3 kLow(-1, 0, -2), kHigh(3, 2, 2);

Box hall() {
    Box box;
    box.add(kLow);
    box.add(kHigh);
    return box;
}

TEST(LightBalls, NewPlacesComeAtOnceAndNewLightWaitsABit) {
    EXPECT_EQ(decideBalls({}), BallStep::None);
    EXPECT_EQ(decideBalls({.wanted = true, .traced = false, .newer = false, .secondsSince = 0}),
              BallStep::Trace);
    EXPECT_EQ(decideBalls({.wanted = true, .traced = true, .newer = false, .secondsSince = 9}),
              BallStep::None);
    EXPECT_EQ(decideBalls({.wanted = true, .traced = true, .newer = true, .secondsSince = 0.01}),
              BallStep::Wait);
    EXPECT_EQ(decideBalls({.wanted = true, .traced = true, .newer = true, .secondsSince = 9}),
              BallStep::Gather);
    EXPECT_EQ(decideBalls({.wanted = false, .traced = false, .newer = true, .secondsSince = 9}),
              BallStep::None);
}

TEST(LightBalls, WhyTheyAreGreyIsTold) {
    EXPECT_EQ(ballProblem({.needed = 80, .free = 100}), "");
    EXPECT_TRUE(contains(ballProblem({.rtrad = true, .free = 100}), "RTRad's preset"));
    constexpr uint64_t kMiB = 1 << 20;
    const std::string full = ballProblem({.needed = 95 * kMiB + 1, .free = 100 * kMiB});
    EXPECT_TRUE(contains(full, "need 96 MiB")) << full;
    EXPECT_TRUE(contains(full, "100 are free")) << full;
}

TEST(LightBalls, AGridOfAViewHasAFewHundredProbesWithinTheScene) {
    const std::vector<glm::vec3> grid = gridOfView(hall());
    EXPECT_GT(grid.size(), 100u);
    EXPECT_LE(grid.size(), 400u);
    for (const glm::vec3& point : grid) {
        EXPECT_TRUE(glm::all(glm::greaterThan(point, kLow)));
        EXPECT_TRUE(glm::all(glm::lessThan(point, kHigh)));
    }
    Box cube; // eight along each edge would be too many
    cube.add(glm::vec3(0));
    cube.add(glm::vec3(1));
    EXPECT_LE(gridOfView(cube).size(), 400u);
    Box floor;
    floor.add({0, 0, 0});
    floor.add({8, 0, 8});
    EXPECT_EQ(gridOfView(floor).size(), 64u);
    EXPECT_TRUE(gridOfView({}).empty());
    Box point;
    point.add({1, 1, 1});
    EXPECT_TRUE(gridOfView(point).empty());
}

TEST(LightBalls, ThePolynomialOfANormalIsLighting) {
    Harmonics light{};
    addLight(light, glm::normalize(glm::dvec3(1, 2, -3)), {10, 20, 30});
    addLight(light, glm::normalize(glm::dvec3(-2, 1, 1)), {3, 0, 1});
    const std::array<glm::vec3, 9> c = lightingPolynomial(light);
    for (const glm::dvec3 axis : {glm::dvec3(0, 1, 0), {1, 0, 0}, {0.3, -0.4, 2}, {-1, -1, 1}}) {
        const glm::dvec3 n = glm::normalize(axis);
        const double values[] = {
            1, n.y, n.z, n.x, n.x * n.y, n.y * n.z, 3 * n.z * n.z - 1, n.x * n.z, n.x * n.x - n.y * n.y};
        glm::dvec3 sum(0.0);
        for (size_t i = 0; i < 9; ++i)
            sum += values[i] * glm::dvec3(c[i]);
        const glm::dvec3 expected = irradiance(light, n) / std::numbers::pi;
        for (int k = 0; k < 3; ++k)
            EXPECT_NEAR(sum[k], expected[k], 1e-5);
    }
}

TEST(LightBalls, ABallGoesAheadOfItsLight) {
    LitBalls lit;
    const glm::vec3 here(1, 1, 0), there(0.5f, 1, 0);
    std::vector<BallDraw::Ball> balls = ballsToDraw(here, lit, hall());
    ASSERT_EQ(balls.size(), 1u);
    EXPECT_EQ(balls[0].kind, BallDraw::Kind::Waiting);
    EXPECT_NEAR(2 * balls[0].radius, hall().diagonal() / 20, 1e-5);
    lit.ball = LitBall{there, {glm::vec3(7)}, false};
    balls = ballsToDraw(here, lit, hall());
    EXPECT_EQ(balls[0].kind, BallDraw::Kind::Lit);
    EXPECT_EQ(balls[0].centre, here) << "where the user has it, not where its light was found";
    EXPECT_EQ(balls[0].lighting[0], glm::vec3(7));
    lit.grid = {{{0, 0, 0}, {}, false}, {{0.5f, 0, 0}, {}, true}};
    balls = ballsToDraw({}, lit, hall());
    ASSERT_EQ(balls.size(), 2u);
    EXPECT_EQ(balls[0].kind, BallDraw::Kind::Lit);
    EXPECT_EQ(balls[1].kind, BallDraw::Kind::Inside);
    EXPECT_LT(2 * balls[1].radius, 0.5f) << "there are gaps";
}

TEST(LightBalls, ARayMeetsABallInFrontOfTheEye) {
    const ScreenRay ray{{0, 0, 5}, {0, 0, -1}};
    EXPECT_NEAR(meetsBall(ray, {0, 0, 0}, 1).value_or(-1), 4, 1e-5);
    EXPECT_FALSE(meetsBall(ray, {0, 1.1f, 0}, 1));
    EXPECT_FALSE(meetsBall(ray, {0, 0, 8}, 1)) << "it is behind";
}

} // namespace
} // namespace relume
