// Samples start all over the part of a texel that the surface covers: edges of shadows are averaged over the
// texel, and no point leaves its surface or gets behind what stands on it.
#include "bake/surface/patch_cover.h"
#include "bake/trace/chunk_starts.h"
#include "tests/gpu/bake_scene.h"
#include "tests/gpu/light_at.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include <glm/gtc/matrix_transform.hpp>

namespace relume {
namespace {

constexpr uint32_t kFloor = 48, kFiner = 4; // texels along an edge, and how many times as many for reference
constexpr float kEdge = 2.0f;               // of the floor [m]

/// Adds a grey material whose backs are no inside of anything.
int bothSides(SceneMaker& maker) {
    Material material;
    material.baseColor = {0.5f, 0.5f, 0.5f, 1.0f};
    material.metallic = 0.0f;
    material.doubleSided = true;
    return maker.material(material);
}

/// Makes a floor below a plate that is turned against the floor's texels by 20 degrees, so that its shadow is
/// a staircase of them. Rays to the light are `samples` per patch.
struct Shade {
    SceneMaker maker;
    TexelRect floor;
    Scene scene;

    Shade(const Light& light, uint32_t finer) : maker(64 * finer) {
        floor =
            maker.quad({0, 0, 0}, kEdge * kX, kEdge * kY, maker.material(0.0f), glm::uvec2(kFloor * finer));
        const glm::vec3 u = 0.8f * glm::vec3(std::cos(0.349f), std::sin(0.349f), 0), v(-u.y, u.x, 0);
        maker.blocker(glm::vec3(1, 1, 0.3f) - 0.5f * (u + v), u, v, bothSides(maker));
        scene = maker.scene();
        scene.lights.push_back(light);
    }

    double at(const FloatImage& image, uint32_t column, uint32_t row) const {
        return texel(image, floor, column, row);
    }
};

Light sun() {
    Light light = lightAt(LightType::Directional, {0, 0, 0}, 3.0f, "Sun");
    light.transform = glm::rotate(glm::mat4(1.0f), 0.35f, glm::vec3(1, 0.4f, 0));
    return light;
}

Light smallLamp() {
    Light light = lightAt(LightType::Point, {1.2f, 0.9f, 2.0f}, 20.0f, "Lamp");
    light.radius = 0.01f;
    return light;
}

/// Returns the relative error of a map against one with finer texels, averaged down.
double errorOf(const Light& light, BakeDesc desc, bool allOver) {
    const Shade coarse(light, 1), fine(light, kFiner);
    BakeDesc reference = desc;
    desc.allOver = allOver;
    reference.allOver = false;
    reference.layers = false;
    desc.size = coarse.maker.size();
    reference.size = fine.maker.size();
    const FloatImage map = bakeScene(coarse.scene, desc).lighting,
                     finer = bakeScene(fine.scene, reference).lighting;
    double squares = 0, sum = 0;
    for (uint32_t row = 0; row < kFloor; ++row) {
        for (uint32_t column = 0; column < kFloor; ++column) {
            double mean = 0;
            for (uint32_t k = 0; k < kFiner * kFiner; ++k)
                mean += fine.at(finer, column * kFiner + k % kFiner, row * kFiner + k / kFiner);
            mean /= kFiner * kFiner;
            squares += std::pow(coarse.at(map, column, row) - mean, 2);
            sum += mean;
        }
    }
    return std::sqrt(squares * kFloor * kFloor) / sum;
}

/// Makes a room of 2 m, cut in two by a wall without thickness that is turned against the texels. The light
/// shines into the part of smaller x alone.
struct TwoRooms {
    SceneMaker maker{128};
    TexelRect floor;
    Scene scene;
    static constexpr float kFrom = 0.83f, kTo = 1.21f; // x of the wall at y = 0 and at y = 2 [m]
    static constexpr uint32_t kTexels = 24;
    static constexpr glm::vec3 kLamp{0.4f, 1.0f, 1.5f};
    static constexpr float kCandela = 20.0f;

    TwoRooms() {
        const int grey = maker.material(0.0f);
        floor = maker.box({0, 0, 0}, {2.0f * kX, 2.0f * kY, 2.0f * kZ}, grey, kTexels)[2];
        const glm::vec3 along(kTo - kFrom, 2, 0);
        maker.blocker({kFrom, 0, 0}, along, 2.0f * kZ, bothSides(maker));
        scene = maker.scene();
        scene.lights.push_back(lightAt(LightType::Point, kLamp, kCandela, "Lamp"));
    }
    // Returns how far the middle of a texel lies in the dark room [m].
    static float inDark(const glm::vec3& p) { return p.x - (kFrom + (kTo - kFrom) * 0.5f * p.y); }
    // Returns the mean light of the points that a patch's samples start from, which all see the lamp.
    static double litMean(const shader::Patch& patch, const shader::PatchCover& cover) {
        constexpr uint32_t kStarts = 4096;
        double sum = 0;
        for (uint32_t number = 0; number < kStarts; ++number) {
            const glm::dvec3 d = glm::dvec3(kLamp) - glm::dvec3(shader::startPoint(patch, cover, number));
            sum += kCandela * d.z / (3.14159265 * std::pow(glm::length(d), 3.0));
        }
        return sum / kStarts;
    }
};

class StartPoints : public testing::TestWithParam<const char*> {
protected:
    static BakeDesc desc() {
        const std::string name = GetParam();
        return {.size = 64,
                .passes = 1,
                .method = name == "directional" ? Method::Directional : Method::Hybrid,
                .samples = 256, // of which a GPU takes few for direct light
                .layers = name == "layers"};
    }
};
INSTANTIATE_TEST_SUITE_P(All, StartPoints, testing::Values("directional", "hybrid", "layers"),
                         [](const auto& test) { return std::string(test.param); });

} // namespace

TEST_P(StartPoints, HalveTheErrorOfAStaircaseInTheSun) {
    const double centre = errorOf(sun(), desc(), false), texel = errorOf(sun(), desc(), true);
    RecordProperty("centre", std::to_string(centre));
    RecordProperty("texel", std::to_string(texel));
    EXPECT_GT(centre, 0.03);
    EXPECT_LE(texel, 0.5 * centre) << centre;
}

TEST_P(StartPoints, HalveTheErrorOfAStaircaseUnderASmallLamp) {
    const double centre = errorOf(smallLamp(), desc(), false), texel = errorOf(smallLamp(), desc(), true);
    RecordProperty("centre", std::to_string(centre));
    RecordProperty("texel", std::to_string(texel));
    EXPECT_GT(centre, 0.03);
    EXPECT_LE(texel, 0.5 * centre) << centre;
}

// A wall crosses texels: their samples stay on the side of the wall that their middle is on.
TEST_P(StartPoints, StayOnTheirSideOfAWall) {
    const TwoRooms rooms;
    BakeDesc bake = desc();
    bake.size = rooms.maker.size();
    const auto baker = makeBaker(rooms.scene, bake);
    while (!baker->solver().done())
        baker->solver().step();
    const std::vector<glm::vec4>& light = baker->solver().light();
    const PatchSet& patches = baker->patches();
    uint32_t crossed = 0, dark = 0;
    for (uint32_t row = 0; row < TwoRooms::kTexels; ++row) {
        for (uint32_t column = 0; column < TwoRooms::kTexels; ++column) {
            const uint32_t i =
                patches.scene
                    .texelToPatch[(rooms.floor.y + row) * rooms.maker.size() + rooms.floor.x + column];
            const glm::vec3 p = patches.scene.patches[i].position;
            const bool crosses = std::abs(TwoRooms::inDark(p)) < 0.5f * 2.0f / TwoRooms::kTexels;
            crossed += crosses && (patches.covers[i].cells & shader::kCoverWhole) == 0;
            if (std::abs(TwoRooms::inDark(p)) < 1e-3f) continue; // on the wall itself
            if (TwoRooms::inDark(p) > 0) {
                ++dark;
                EXPECT_EQ(light[i].r, 0.0f) << column << ", " << row;
            } else if (crosses) {
                const double whole = rooms.litMean(patches.scene.patches[i], patches.covers[i]);
                EXPECT_NEAR(light[i].r, whole, 1e-3 * whole) << column << ", " << row;
            }
        }
    }
    EXPECT_GT(crossed, TwoRooms::kTexels / 2);
    EXPECT_GT(dark, TwoRooms::kTexels * TwoRooms::kTexels / 4);
}

TEST_P(StartPoints, AreThoseOfEveryTracer) {
    if (desc().layers) GTEST_SKIP() << "layers trace as hybrid does";
    expectTracersAgree(Shade(smallLamp(), 1).scene, desc(), 2e-3);
}

// A chart's edge may cross texels anywhere: every cell that is taken lies on the chart.
TEST(PatchCover, LiesOnTheSurface) {
    SceneMaker maker(64);
    maker.disc({0, 0, 0}, kX, 0.7f * kY, maker.material(0.5f), 40);
    const auto baker =
        makeBaker(maker.scene(), {.size = 64, .passes = 1, .method = Method::Hybrid, .samples = 16});
    const PatchSet& patches = baker->patches();
    uint32_t whole = 0, parts = 0;
    for (uint32_t i = 0; i < patches.count; ++i) {
        const shader::PatchCover& cover = patches.covers[i];
        ASSERT_NE(cover.cells, 0u);
        for (uint32_t number = 0; number < 64; ++number) {
            const glm::vec3 p = shader::startPoint(patches.scene.patches[i], cover, number);
            EXPECT_LE(p.x * p.x + p.y * p.y / 0.49f, 1.0f + 1e-3f);
            EXPECT_NEAR(p.z, 0.0f, 1e-6f);
        }
        if ((cover.cells & shader::kCoverWhole) != 0) {
            ++whole;
            continue;
        }
        ++parts;
    }
    EXPECT_GT(whole, 4 * parts);
    EXPECT_GT(parts, 40u);
}

// Samples of a whole texel lie all over it, as evenly as their numbers are.
TEST(PatchCover, PointsFillATexel) {
    shader::Patch patch{};
    patch.flags = shader::kPatchSends | 1234u << shader::kTexelShift;
    const shader::PatchCover cover{kX, shader::kCoverCells | shader::kCoverWhole, kY,
                                   shader::kCoverPlaces / 2 | shader::kCoverPlaces / 2 << 16};
    constexpr uint32_t kSamples = 4 * 256;
    std::array<uint32_t, 64> cells{};
    for (uint32_t number = 0; number < kSamples; ++number) {
        const glm::vec3 p = shader::startPoint(patch, cover, number) + 0.5f;
        ++cells[static_cast<size_t>(p.y * 8) * 8 + static_cast<size_t>(p.x * 8)];
    }
    for (const uint32_t count : cells)
        EXPECT_EQ(count, kSamples / 64);
}

// The CPU's loops over a chunk make the points of the shaders, of whole texels and of parts of them.
TEST(PatchCover, ChunksHaveThePointsOfTheirPatches) {
    std::array<shader::Patch, shader::kChunk> patches{};
    std::array<shader::PatchCover, shader::kChunk> covers{};
    for (uint32_t i = 0; i < shader::kChunk; ++i) {
        const auto x = static_cast<float>(i);
        patches[i].position = {x, 2 * x, 3};
        patches[i].flags = shader::kPatchSends | (7 * i) << shader::kTexelShift;
        const uint32_t part = (0x9e3779b9u * (i + 1)) & shader::kCoverCells;
        covers[i] = {kX + kZ,
                     i % 3 == 0   ? 0
                     : i % 3 == 1 ? part
                                  : shader::kCoverCells | shader::kCoverWhole,
                     kY, 1000 * i | 500 * i << 16};
    }
    ChunkStarts starts;
    ChunkStarts::Points points;
    starts.setPatches(patches.data(), covers.data());
    for (uint32_t number = 0; number < 64; ++number) {
        starts.make(number, points);
        for (uint32_t i = 0; i < shader::kChunk; ++i) {
            const glm::vec3 made(points.x[i], points.y[i], points.z[i]);
            EXPECT_LE(glm::distance(made, shader::startPoint(patches[i], covers[i], number)), 1e-4f) << i;
        }
    }
    starts.setPatches(patches.data(), nullptr);
    starts.make(5, points);
    EXPECT_FALSE(starts.move());
    EXPECT_EQ(points.y[20], 40.0f);
}

// Each of the four replicates has as many of a sample pass's points, whatever lights they go to.
TEST(PatchCover, TargetsAreNumberedThroughSamplePasses) {
    for (const uint32_t run : {1u, 4u}) {
        const uint32_t turn = 16;
        std::array<uint32_t, 32> found{};
        for (uint32_t samplePass = 0; samplePass < 2; ++samplePass)
            for (uint32_t t = 0; t < turn; ++t) {
                EXPECT_EQ(shader::startNumber(t, samplePass, turn, run),
                          shader::startNumber(t + turn, samplePass, turn, run));
                ++found[shader::startNumber(t, samplePass, turn, run)];
                EXPECT_EQ(shader::startNumber(t, samplePass, turn, run) % shader::kReplicates,
                          t / run % shader::kReplicates);
            }
        for (const uint32_t count : found)
            EXPECT_EQ(count, 1u);
    }
}

} // namespace relume
