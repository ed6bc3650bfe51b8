// This tests which side of a surface sends, receives and blocks.
#include "assets/base/log.h"
#include "bake/trace/make_tracer.h"
#include "tests/gpu/bake_scene.h"
#include "tests/log_capture.h"
#include "tests/unit/closed_forms.h"

#include <gtest/gtest.h>

#include <sstream>

namespace relume {
namespace {

/// Holds squares below and above the origin's plane, both looking at it.
struct Witnesses {
    TexelRect below, above;
};
Witnesses addWitnesses(SceneMaker& maker) {
    const int black = maker.material(0.0f);
    return {maker.quad({0, 0, -1}, kX, kY, black, glm::uvec2(16)),
            maker.quad({0, 0, 1}, kY, kX, black, glm::uvec2(16))};
}

const double kParallel = closed::parallelRectangles(1, 1, 1);

} // namespace

TEST(Sides, SingleSidedEmitterSendsFromItsFrontAlone) {
    SceneMaker maker(64);
    const Witnesses w = addWitnesses(maker);
    const TexelRect lamp = maker.quad({0, 0, 0}, kX, kY, maker.material(0.0f, 1.0f), glm::uvec2(32));
    const Baked baked = bakeScene(maker.scene(), {.size = 64});
    EXPECT_NEAR(statistics(baked.lighting, w.above).mean, kParallel, 0.01 * kParallel);
    // The one below sees nothing but the back and counts as shut in.
    EXPECT_EQ(statistics(baked.lighting, lamp).max, 0.0);
    for (uint32_t row = 0; row < w.below.height; ++row) {
        for (uint32_t column = 0; column < w.below.width; ++column)
            EXPECT_EQ(texel(baked.lighting, w.below, column, row), 0.0);
    }
}

TEST(Sides, DoubleSidedEmitterSendsFromBothSides) {
    SceneMaker maker(64);
    const Witnesses w = addWitnesses(maker);
    Material m;
    m.baseColor = glm::vec4(0, 0, 0, 1);
    m.emission = glm::vec3(1);
    m.doubleSided = true;
    const TexelRect lamp = maker.quad({0, 0, 0}, kX, kY, maker.material(m), glm::uvec2(32));
    const Baked baked = bakeScene(maker.scene(), {.size = 64});
    EXPECT_NEAR(statistics(baked.lighting, w.above).mean, kParallel, 0.01 * kParallel);
    EXPECT_NEAR(statistics(baked.lighting, w.below).mean, kParallel, 0.01 * kParallel);
    EXPECT_EQ(statistics(baked.lighting, w.below).count, w.below.width * w.below.height);
    EXPECT_EQ(statistics(baked.lighting, lamp).max, 0.0);
}

// A mesh light behind the receiver leaves it dark, for its back must not receive; one in front lights it.
TEST(Sides, DoubleSidedReceiverShowsItsFront) {
    SceneMaker maker(64);
    Material m;
    m.baseColor = glm::vec4(0, 0, 0, 1);
    m.metallic = 0;
    m.doubleSided = true;
    const TexelRect card = maker.quad({0, 0, 0}, kX, kY, maker.material(m), glm::uvec2(16));
    const int lamp = maker.material(0.0f, 1.0f);
    maker.quad({0, 0, -1}, kX, kY, lamp, glm::uvec2(16)); // below, behind it
    EXPECT_EQ(statistics(bakeScene(maker.scene(), {.size = 64}).lighting, card).max, 0.0);
    maker.quad({0, 0, 1}, kY, kX, lamp, glm::uvec2(16)); // above, in front
    EXPECT_NEAR(statistics(bakeScene(maker.scene(), {.size = 64}).lighting, card).mean, kParallel,
                0.01 * kParallel);
}

TEST(Sides, MirroredInstanceKeepsItsFront) {
    SceneMaker maker(64);
    const Witnesses w = addWitnesses(maker);
    maker.quad({0, 0, 0}, kX, kY, maker.material(0.0f, 1.0f), glm::uvec2(32));
    maker.lastInstance().transform =
        glm::mat4(glm::vec4(-1, 0, 0, 0), {0, 1, 0, 0}, {0, 0, 1, 0}, {1, 0, 0, 1});
    const Baked baked = bakeScene(maker.scene(), {.size = 64});
    EXPECT_NEAR(statistics(baked.lighting, w.above).mean, kParallel, 0.01 * kParallel);
    EXPECT_EQ(texel(baked.lighting, w.below, 8, 8), 0.0);
}

// In a mirrored furnace, walls turned inside out would be black.
TEST(Sides, MirroredRoomIsAFurnaceStill) {
    SceneMaker maker(64);
    const auto walls =
        maker.box({0, 0, 0}, {glm::vec3(1, 0, 0), {0, 1, 0}, {0, 0, 1}}, maker.material(0.0f, 1.0f), 16);
    Scene scene = maker.scene();
    for (Instance& instance : scene.instances)
        instance.transform = glm::mat4(glm::vec4(1, 0, 0, 0), {0, -1, 0, 0}, {0, 0, 1, 0}, {3, 2, 1, 1});
    const Baked baked = bakeScene(scene, {.size = 64});
    for (const TexelRect& wall : walls)
        EXPECT_NEAR(statistics(baked.lighting, wall).mean, 1.0, 0.005);
}

class Masked : public testing::TestWithParam<TracerKind> {};

// A screen whose one half is a hole does what half a screen does, and only its solid half has patches.
TEST_P(Masked, HolesLetLightPass) {
    const std::vector<TracerKind> kinds = tracersOfTestDevice();
    if (std::find(kinds.begin(), kinds.end(), GetParam()) == kinds.end())
        GTEST_SKIP() << tracerName(GetParam()) << " does not run on this device";
    const auto bake = [&](bool masked, uint32_t& screenTexels) {
        SceneMaker maker(80);
        const TexelRect floor = maker.quad({0, 0, 0}, kX, kY, maker.material(0.0f), glm::uvec2(24));
        // There are 25 texels, so that no ray meets the hole's edge itself.
        maker.quad({0, 0, 1}, kY, kX, maker.material(0.0f, 1.0f), glm::uvec2(25));
        Material m;
        m.baseColor = glm::vec4(0, 0, 0, 1);
        m.doubleSided = true;
        TexelRect screen;
        if (masked) {
            m.alphaMode = AlphaMode::Mask;
            m.baseColorTexture.texture = maker.alphaTexture(2, 1, {0, 255});
            screen = maker.quad({-0.5f, -0.5f, 0.5f}, 2.0f * kX, 2.0f * kY, maker.material(m), {16, 16});
        } else {
            screen = maker.quad({0.5f, -0.5f, 0.5f}, kX, 2.0f * kY, maker.material(m), {8, 16});
        }
        const Baked baked = bakeScene(maker.scene(), {.size = 80, .tracer = GetParam()});
        screenTexels = statistics(baked.lighting, screen).count;
        return std::pair(baked.lighting, floor);
    };
    uint32_t withHole = 0, half = 0;
    const auto [through, floor] = bake(true, withHole);
    const auto [beside, sameFloor] = bake(false, half);
    EXPECT_EQ(withHole, half);
    EXPECT_EQ(half, 8u * 16u);
    const double mean = statistics(beside, floor).mean;
    EXPECT_GT(mean, 0.2 * kParallel);
    EXPECT_LT(mean, 0.8 * kParallel);
    for (uint32_t row = 0; row < floor.height; ++row) {
        for (uint32_t column = 0; column < floor.width; ++column)
            EXPECT_NEAR(texel(through, floor, column, row), texel(beside, floor, column, row), 1e-6);
    }
}

// Holes neither emit nor shine through as if they did.
TEST_P(Masked, HolesDoNotEmit) {
    const std::vector<TracerKind> kinds = tracersOfTestDevice();
    if (std::find(kinds.begin(), kinds.end(), GetParam()) == kinds.end())
        GTEST_SKIP() << tracerName(GetParam()) << " does not run on this device";
    SceneMaker maker(64);
    const TexelRect floor = maker.quad({0, 0, 0}, kX, kY, maker.material(0.0f), glm::uvec2(16));
    Material m;
    m.baseColor = glm::vec4(0, 0, 0, 1);
    m.emission = glm::vec3(1);
    m.alphaMode = AlphaMode::Mask;
    m.baseColorTexture.texture = maker.alphaTexture(2, 1, {0, 255});
    // u is x here and v is -y, so the front looks down; the hole is the half with x < 0.5.
    const TexelRect lamp = maker.quad({0, 1, 1}, kX, -kY, maker.material(m), glm::uvec2(32));
    const Baked baked = bakeScene(maker.scene(), {.size = 64, .tracer = GetParam()});
    EXPECT_EQ(statistics(baked.lighting, lamp).count, 16u * 32u);
    double exact = 0;
    for (uint32_t column = 0; column < 16; ++column) {
        for (uint32_t row = 0; row < 16; ++row)
            exact += closed::integratedParallelogram({(column + 0.5) / 16, (row + 0.5) / 16, 0}, {0, 0, 1},
                                                     {0.5, 1, 1}, {0.5, 0, 0}, {0, -1, 0}, 1e-6) /
                     256;
    }
    EXPECT_NEAR(statistics(baked.lighting, floor).mean, exact, 0.01 * exact);
}

INSTANTIATE_TEST_SUITE_P(Tracers, Masked,
                         testing::Values(TracerKind::Embree, TracerKind::Bvh, TracerKind::Query,
                                         TracerKind::Rtp),
                         [](const auto& test) { return std::string(tracerName(test.param)); });

TEST(Albedo, AboveTheLimitIsClampedWithAWarning) {
    SceneMaker maker(64);
    const auto walls =
        maker.box({0, 0, 0}, {glm::vec3(1, 0, 0), {0, 1, 0}, {0, 0, 1}}, maker.material(1.0f, 1.0f), 8);
    LogCapture log;
    const Baked baked = bakeScene(maker.scene(), {.size = 64, .passes = 2});
    EXPECT_NE(log.text().find("albedo above 0.98"), std::string::npos) << log.text();
    EXPECT_EQ(baked.patches.clampedAlbedo, 6u * 8u * 8u);
    for (uint32_t i = 0; i < baked.patches.count; ++i)
        EXPECT_FLOAT_EQ(baked.patches.albedo[i].r, 0.98f);
    // After two bounces, a wall shows 1 + a L2, L2 = 1 + a.
    EXPECT_NEAR(statistics(baked.radiance, walls[0]).mean, 1 + 0.98 * (1 + 0.98), 0.02);
}

TEST(Albedo, BelowTheLimitGivesNoWarning) {
    SceneMaker maker(64);
    maker.box({0, 0, 0}, {glm::vec3(1, 0, 0), {0, 1, 0}, {0, 0, 1}}, maker.material(0.97f, 1.0f), 8);
    LogCapture log;
    EXPECT_EQ(bakeScene(maker.scene(), {.size = 64}).patches.clampedAlbedo, 0u);
    EXPECT_EQ(log.text(), "");
}

} // namespace relume
