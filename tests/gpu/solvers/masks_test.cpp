// Masks whose holes are finer than the lightmap do what the same holes do as geometry, by all methods.
#include "tests/gpu/bake_scene.h"
#include "tests/gpu/gpu_environment.h"
#include "tests/gpu/light_at.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace relume {
namespace {

constexpr uint32_t kFenceMap = 128, kFenceTexels = 32;
constexpr uint32_t kBars = 20; // in 2 m

/// A fence, or something else, that a spot lights from between it and a black ceiling, which sees it.
struct LitFence {
    Scene scene;
    TexelRect ceiling;
    std::vector<TexelRect> fence;
};

LitFence addRest(SceneMaker& maker, std::vector<TexelRect> fence) {
    const TexelRect ceiling =
        maker.quad({-1, -1, 1}, 2.0f * kY, 2.0f * kX, maker.material(0.0f), glm::uvec2(kFenceTexels));
    LitFence result{maker.scene(), ceiling, std::move(fence)};
    Light spot = lightAt(LightType::Spot, {0, 0, 0.5f}, 100.0f, "Spot");
    spot.innerConeAngle = 0.9f;
    spot.outerConeAngle = 1.0f;
    result.scene.lights.push_back(spot);
    return result;
}

Material fenceMaterial() {
    Material m;
    m.baseColor = glm::vec4(0.5f, 0.5f, 0.5f, 1.0f);
    m.metallic = 0.0f;
    return m;
}

/// The fence is one square with a mask of `edge` texels squared. Its holes are black, its rest is white.
template<class IsSolid>
LitFence maskedFence(uint32_t edge, const IsSolid& isSolid) {
    SceneMaker maker(kFenceMap);
    std::vector<uint8_t> alpha;
    for (uint32_t y = 0; y < edge; ++y)
        for (uint32_t x = 0; x < edge; ++x)
            alpha.push_back(isSolid(x, y) ? 255 : 0);
    Material m = fenceMaterial();
    m.alphaMode = AlphaMode::Mask;
    m.baseColorTexture.texture = maker.alphaTexture(edge, edge, alpha);
    const TexelRect square =
        maker.quad({-1, -1, 0}, 2.0f * kX, 2.0f * kY, maker.material(m), glm::uvec2(kFenceTexels));
    LitFence result = addRest(maker, {square});
    std::vector<uint8_t>& rgba = result.scene.images[0].rgba;
    for (size_t i = 0; i < rgba.size(); i += 4)
        rgba[i] = rgba[i + 1] = rgba[i + 2] = rgba[i + 3];
    return result;
}

/// The same with bars along y as quads, which take this share of the square.
LitFence quadFence(float share) {
    SceneMaker maker(kFenceMap);
    const int material = maker.material(fenceMaterial());
    const float period = 2.0f / kBars;
    std::vector<TexelRect> bars;
    for (uint32_t i = 0; i < kBars; ++i)
        bars.push_back(maker.quad({-1.0f + period * static_cast<float>(i), -1, 0}, share * period * kX,
                                  2.0f * kY, material, {2, kFenceTexels}));
    return addRest(maker, std::move(bars));
}

struct MaskCase {
    const char* name;
    BakeDesc desc;
    double error; // relative, of means
};
void PrintTo(const MaskCase& c, std::ostream* out) {
    *out << c.name;
}

double mean(const Baked& baked, const std::vector<TexelRect>& rects) {
    double sum = 0, count = 0;
    for (const TexelRect& rect : rects) {
        const TexelStatistics s = statistics(baked.lighting, rect);
        sum += s.mean * s.count, count += s.count;
    }
    return sum / count;
}

class Masks : public testing::TestWithParam<MaskCase> {
protected:
    static Baked bake(const LitFence& fence) {
        BakeDesc desc = GetParam().desc;
        desc.size = kFenceMap;
        desc.passes = 2;
        return bakeScene(fence.scene, desc);
    }
};

// Monte-Carlo draws one of four patches, whose areas differ much: that is its noise.
INSTANTIATE_TEST_SUITE_P(
    Methods, Masks,
    testing::Values(MaskCase{"hybrid", {.method = Method::Hybrid, .samples = 1024}, 0.02},
                    MaskCase{"directional", {.method = Method::Directional, .samples = 1024}, 0.02},
                    MaskCase{"pure", {.method = Method::Pure}, 0.02},
                    MaskCase{"montecarlo", {.method = Method::MonteCarlo, .pairs = {.window = 2}}, 0.06},
                    MaskCase{"mipmapped", {.method = Method::Mipmapped, .pairs = {.window = 2}}, 0.03}),
    [](const auto& test) { return std::string(test.param.name); });

} // namespace

// By a mean of their alpha, bars of 40 % would all be holes and bars of 60 % would have none between them.
TEST_P(Masks, DoAsTheSameBarsOfQuads) {
    for (const uint32_t tenths : {4u, 6u}) {
        const LitFence masked =
            maskedFence(10 * kBars, [&](uint32_t x, uint32_t) { return x % 10 < tenths; });
        const LitFence quads = quadFence(0.1f * static_cast<float>(tenths));
        const Baked bakedMask = bake(masked), bakedQuads = bake(quads);
        EXPECT_EQ(statistics(bakedMask.lighting, masked.fence[0]).count, kFenceTexels * kFenceTexels);
        const double onQuads = mean(bakedQuads, {quads.ceiling});
        EXPECT_GT(onQuads, 0.5);
        EXPECT_NEAR(mean(bakedMask, {masked.ceiling}) / onQuads, 1.0, GetParam().error) << tenths;
        // What the spot brings to the bars themselves is sharper than texels at the edge of its cone.
        EXPECT_NEAR(mean(bakedMask, masked.fence) / mean(bakedQuads, quads.fence), 1.0, 0.02) << tenths;
    }
}

// Holes that lie anywhere take their share of what a square without holes sends.
TEST_P(Masks, SendTheirShareOfWhatAWholeSquareSends) {
    constexpr uint32_t kEdge = 256;
    const LitFence whole = maskedFence(1, [](uint32_t, uint32_t) { return true; });
    const double all = mean(bake(whole), {whole.ceiling});
    for (const double share : {0.25, 0.7}) {
        std::mt19937 random(7);
        uint32_t solid = 0;
        const LitFence leaves = maskedFence(kEdge, [&](uint32_t, uint32_t) {
            const bool isSolid = random() < share * 4294967296.0;
            solid += isSolid ? 1u : 0u;
            return isSolid;
        });
        const double expected = all * solid / (double{kEdge} * kEdge);
        EXPECT_NEAR(mean(bake(leaves), {leaves.ceiling}) / expected, 1.0, GetParam().error) << share;
    }
}

} // namespace relume
