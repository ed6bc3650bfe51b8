// This tests what must not change a lightmap, and where there must be no light at all.
#include "assets/generate/generate.h"
#include "tests/gpu/bake_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace relume {
namespace {

constexpr uint32_t kScaledSize = 128; // the scenes' charts lie on multiples of 1/128

/// Returns the instance that each patch belongs to.
std::vector<uint32_t> instanceOfPatch(const PatchSet& patches) {
    const WorldMesh& mesh = patches.scene.mesh;
    std::vector<uint32_t> ofChart(mesh.chartCount, ~0u), ofPatch(patches.scene.patches.size(), ~0u);
    for (uint32_t t = 0; t < mesh.triangleCount(); ++t) {
        if (mesh.chart[t] != kNoChart) ofChart[mesh.chart[t]] = mesh.instance[t];
    }
    for (size_t i = 0; i < ofPatch.size(); ++i) {
        if (patches.scene.patchChart[i] != kNoChart) ofPatch[i] = ofChart[patches.scene.patchChart[i]];
    }
    return ofPatch;
}

} // namespace

// A texel's point must lie in its triangle's plane by far more than a patch's offset, else rays start behind
// it. The thin triangles of the disc once put them beside it.
TEST(Invariance, TexelCentresLieInTheirPlane) {
    SceneMaker maker(65);
    maker.disc({5, -3, 1}, {0, 1, 0}, {1, 0, 0}, maker.material(0.5f), 64);
    const Baked baked = bakeScene(maker.scene(), {.size = maker.size()});
    EXPECT_EQ(baked.invalid, 0u);
    for (uint32_t i = 0; i < baked.patches.count; ++i)
        EXPECT_NEAR(baked.patches.scene.patches[i].position.z, 1.0f, 2e-7f) << "patch " << i;
}

TEST(Scale, GivesTheSameMap) {
    const Scene scene = generateScene("cornell_geom");
    const Baked metres = bakeScene(scene, {.size = kScaledSize, .passes = 2});
    EXPECT_GT(statistics(metres.lighting, {0, 0, kScaledSize, kScaledSize}).mean, 0.1);
    for (const float factor : {0.01f, 1000.0f}) {
        const Baked other = bakeScene(scaled(scene, factor), {.size = kScaledSize, .passes = 2});
        EXPECT_EQ(metres.patches.count, other.patches.count) << factor;
        EXPECT_EQ(metres.invalid, other.invalid) << factor;
        EXPECT_LT(relativeError(other.lighting, metres.lighting), 1e-4) << factor;
    }
}

// No light gets into the closed cell of cornell_layers, through no edge and no corner.
TEST(Invariance, ADarkCellStaysDark) {
    const Scene scene = generateScene("cornell_layers");
    const Baked baked = bakeScene(scene, {.size = kScaledSize, .passes = 3});
    const std::vector<uint32_t> instance = instanceOfPatch(baked.patches);
    uint32_t inside = 0, lit = 0;
    double outside = 0;
    for (uint32_t texel = 0; texel < kScaledSize * kScaledSize; ++texel) {
        const uint32_t patch = baked.patches.scene.texelToPatch[texel];
        if (patch == shader::kNoPatch || baked.lighting.planes[3][texel] != 1.0f) continue;
        const double value = std::max({baked.lighting.planes[0][texel], baked.lighting.planes[1][texel],
                                       baked.lighting.planes[2][texel]});
        if (scene.instances[instance[patch]].name == "Cell inside") {
            ++inside;
            lit += value != 0.0;
        } else {
            outside += value;
        }
    }
    EXPECT_GT(inside, 300u);
    EXPECT_EQ(lit, 0u) << "of " << inside;
    EXPECT_GT(outside, 1000.0);
}

} // namespace relume
