// More samples bring less error, told as well as true, however a scene is lit; and what they converge to is
// right.
#include "assets/generate/generate.h"
#include "tests/gpu/bake_scene.h"
#include "tests/unit/closed_forms.h"

#include <gtest/gtest.h>

#include <cmath>

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

// There are thousands of mesh lights, and some patches lie right beside a large one: what a few points of a
// sample pass tell of it must have nothing to do with how their numbers were scrambled, or the replicates
// never agree.
TEST(Convergence, DirectLightOfManyEmittersGoesOnConverging) {
    const Scene scene = generateScene("atrium");
    constexpr uint32_t few = 1024, many = 16384;
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
