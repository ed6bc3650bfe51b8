// More samples bring less error, told as well as true, however a scene is lit; and what they converge to is
// right.
#include "assets/generate/generate.h"
#include "bake/gather/link_passes.h"
#include "tests/gpu/bake_scene.h"
#include "tests/gpu/gpu_environment.h"
#include "tests/unit/closed_forms.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

namespace relume {
namespace {

// Errors fall at least as samples^-0.4: those of the lamps by 3.2 from 64 to 1,024 samples, as few tell
// theirs with noise.
constexpr double kLeastExponent = 0.4;

BakeDesc hybrid(uint32_t size, uint32_t samples, uint32_t passes = 0) {
    return {.size = size, .passes = passes, .method = Method::Hybrid, .samples = samples, .smooth = true};
}

double leastFall(double times) {
    return std::pow(times, kLeastExponent);
}

class Convergence : public testing::TestWithParam<std::string> {};

/// Adds the wall with edges u and v around a hole from `low` to `high` [m].
void wallWithHole(SceneMaker& maker, glm::vec3 corner, glm::vec3 u, glm::vec3 v, glm::vec2 low,
                  glm::vec2 high, int material) {
    const glm::vec3 x = glm::normalize(u), y = glm::normalize(v);
    const auto part = [&](float x0, float x1, float y0, float y1) {
        if (x1 > x0 && y1 > y0)
            maker.quad(corner + x0 * x + y0 * y, (x1 - x0) * x, (y1 - y0) * y, material, {10, 10});
    };
    part(0, low.x, 0, glm::length(v));
    part(high.x, glm::length(u), 0, glm::length(v));
    part(low.x, high.x, 0, low.y);
    part(low.x, high.x, high.y, glm::length(v));
}

/// A room with a weak lamp or a window, another that has a door to it, and a bright square outside.
struct Flat {
    SceneMaker maker{96};
    std::vector<TexelRect> inner; // of the room behind

    bool window = false;

    explicit Flat(bool hasWindow = false) : window(hasWindow) {
        const int grey = maker.material(0.6f);
        maker.quad({20, -20, 0}, 40.0f * kX, 40.0f * kY, grey, {40, 40});
        const auto room = [&](float x, std::vector<TexelRect>* rects) { // but for the walls along y
            const std::array<std::array<glm::vec3, 3>, 4> walls = {
                {{glm::vec3(x, 0, 0), 4.0f * kX, 3.0f * kY},
                 {glm::vec3(x, 0, 3), 3.0f * kY, 4.0f * kX},
                 {glm::vec3(x, 0, 0), 3.0f * kZ, 4.0f * kX},
                 {glm::vec3(x, 3, 0), 4.0f * kX, 3.0f * kZ}}};
            for (const auto& [corner, u, v] : walls) {
                const TexelRect rect = maker.quad(corner, u, v, grey, {14, 14});
                if (rects) rects->push_back(rect);
            }
        };
        room(0, nullptr);
        room(-4, &inner);
        if (window)
            wallWithHole(maker, {4, 0, 0}, 3.0f * kZ, 3.0f * kY, {0.5f, 0.5f}, {2.5f, 2.5f}, grey);
        else
            maker.quad({4, 0, 0}, 3.0f * kZ, 3.0f * kY, grey, {14, 14});
        wallWithHole(maker, {0, 0, 0}, 3.0f * kY, 3.0f * kZ, {1, 0}, {2, 2}, grey);
        wallWithHole(maker, {0, 0, 0}, 3.0f * kZ, 3.0f * kY, {0, 1}, {2, 2}, grey);
        inner.push_back(maker.quad({-4, 0, 0}, 3.0f * kY, 3.0f * kZ, grey, {14, 14}));
    }
    Scene scene() const {
        Scene scene = maker.scene();
        scene.sky.radiance = glm::vec3(1000.0f);
        Light lamp; // it shines down
        lamp.type = LightType::Rectangle;
        lamp.intensity = 1.0f;
        lamp.transform[3] = glm::vec4(2.0f, 1.5f, 2.9f, 1.0f);
        if (!window) scene.lights = {lamp};
        return scene;
    }
    double light(const Baked& baked) const {
        double sum = 0;
        for (const TexelRect& rect : inner)
            sum += statistics(baked.lighting, rect).mean / double(inner.size());
        return sum;
    }
};

} // namespace

TEST_P(Convergence, ErrorsFallAsSamplesComeIn) {
    constexpr uint32_t few = 64, many = 1024, reference = 4096, size = 32;
    const Scene scene = generateScene(GetParam());
    const Baked first = bakeScene(scene, hybrid(size, few)), then = bakeScene(scene, hybrid(size, many)),
                last = bakeScene(scene, hybrid(size, reference));
    const double fall = leastFall(double(many) / few);
    EXPECT_GT(first.progress.error, fall * then.progress.error) << "told";
    EXPECT_GT(then.progress.error, leastFall(double(reference) / many) * last.progress.error) << "told";
    const double before = relativeError(first.lighting, last.lighting),
                 after = relativeError(then.lighting, last.lighting);
    EXPECT_GT(before, fall * after) << "true";
    // The reference has its own error, and a few bright texels decide that of few samples.
    EXPECT_LT(after, 2.0 * (then.progress.error + last.progress.error));
    EXPECT_LT(before, 3.0 * first.progress.error);
}

INSTANTIATE_TEST_SUITE_P(Scenes, Convergence, testing::ValuesIn([] {
                             std::vector<std::string> names;
                             for (const SceneName& scene : generatedSceneNames())
                                 if (scene.hasLightmapUvs) names.push_back(scene.name);
                             return names;
                         }()),
                         [](const auto& test) { return test.param; });

// Next to nothing of a level's mean light lies in a room that the sun does not reach, and nearly all that is
// there has come by bounces: bounces that end when the mean light tells no more leave it too dark.
TEST(Convergence, RoomsOfABrightLevelHaveAllTheirBounces) {
    const Flat flat;
    BakeDesc desc = hybrid(flat.maker.size(), 4096);
    const double wanted = flat.light(bakeScene(flat.scene(), desc));
    ASSERT_GT(wanted, 0.0);
    ASSERT_LT(wanted, 0.1) << "next to nothing beside the square's 1,000";
    desc.samples = 64;
    for (const bool layers : {false, true}) {
        desc.layers = layers;
        EXPECT_NEAR(flat.light(bakeScene(flat.scene(), desc)) / wanted, 1.0, 0.03) << layers;
    }
}

// The first look at a layer, whose bounces are in haste, has the error that is asked for. It must not be the
// last one.
TEST(Convergence, ALayerDoesNotEndInHaste) {
    const Flat flat(true);
    const double wanted = flat.light(bakeScene(flat.scene(), hybrid(flat.maker.size(), 4096)));
    BakeDesc desc = hybrid(flat.maker.size(), 0);
    desc.error = 0.5;
    desc.localError = 1.0;
    desc.layers = true;
    const Baked coarse = bakeScene(flat.scene(), desc);
    constexpr uint32_t kFew = 4; // sample passes; a GPU's have more links
    EXPECT_LE(coarse.progress.samples, kFew * linksOfSamplePass(1, 0, testDevice().info().software()));
    EXPECT_NEAR(flat.light(coarse) / wanted, 1.0, 0.1);
}

// There are thousands of mesh lights, and some patches lie right beside a large one: what a few points of a
// sample pass tell of it must have nothing to do with how their numbers were scrambled, or the replicates
// never agree.
TEST(Convergence, DirectLightOfManyEmittersGoesOnConverging) {
    const Scene scene = generateScene("atrium");
    constexpr uint32_t few = 256, many = 4096;
    const Baked first = bakeScene(scene, hybrid(32, few, 1)), then = bakeScene(scene, hybrid(32, many, 1));
    EXPECT_GT(first.progress.error, leastFall(double(many) / few) * then.progress.error);
}

// A large mesh light hangs near the floor, half of it hidden by a plate right below it: what is seen of it is
// a rectangle of known form factor. Small ones beside it, which shine away from the floor, make it one of
// many, of which each patch picks some.
TEST(Convergence, AHalfHiddenNearEmitterAmongManyIsRight) {
    constexpr float height = 0.2f, edge = 0.7f, gap = 0.001f;
    constexpr uint32_t texels = 24;
    // Alone it gets as many points as there are links, among few a quarter of them; among more than
    // EmitterLight::kAllEmitters it is picked.
    const std::vector<std::pair<uint32_t, uint32_t>> cases{{0, 4096}, {8, 16384}, {300, 4096}};
    for (const auto& [others, samples] : cases) {
        SceneMaker maker(64);
        const int lit = maker.material(0.0f, 1.0f), black = maker.material(0.0f);
        const TexelRect floor = maker.quad({0, 0, 0}, 2.0f * kX, 2.0f * kY, black, glm::uvec2(texels));
        maker.quad({0, 0, height}, 2.0f * kY, 2.0f * kX, lit, glm::uvec2(4));
        maker.blocker({-1, -1, height - gap}, 4.0f * kY, (1.0f + edge) * kX, black); // its front is below
        for (uint32_t i = 0; i < others; ++i)
            maker.blocker({3.0f + float(i), 0, 0}, 0.1f * kX, 0.1f * kY, lit);
        const Baked baked = bakeScene(maker.scene(), hybrid(maker.size(), samples, 1));
        for (uint32_t row = 0; row < texels; row += 5) {
            for (uint32_t column = 0; column < texels; ++column) {
                const glm::dvec3 p((column + 0.5) * 2.0 / texels, (row + 0.5) * 2.0 / texels, 0.0);
                const double from = p.x + (edge - p.x) * height / (height - gap);
                const double exact = closed::integratedParallelogram(
                    {p.x, p.y, p.z}, {0, 0, 1}, {from, 0, height}, {0, 2, 0}, {2.0 - from, 0, 0}, 1e-6);
                EXPECT_NEAR(texel(baked.lighting, floor, column, row), exact, 0.01)
                    << others << " others, texel " << column << ", " << row;
            }
        }
    }
}

} // namespace relume
