// SewSeams, cut into what each chunk of patches is responsible for, is held against makeLightmap, which fills
// whole maps.
#include "bake/output/lightmap.h"

#include "assets/base/worker_pool.h"
#include "bake/surface/seam_plan.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace relume {
namespace {

// Makes patches at random texels in tile order, some of them inside something; `share` is that of texels with
// a patch.
PatchSet randomPatches(uint32_t size, double share, uint32_t seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    PatchSet set;
    set.scene.size = size;
    set.scene.texelToPatch.assign(size_t{size} * size, shader::kNoPatch);
    const uint32_t tiles = (size + 7) / 8;
    for (uint32_t tile = 0; tile < tiles * tiles; ++tile) {
        const bool covered = uniform(random) < share;
        for (uint32_t in = 0; in < 64; ++in) {
            const uint32_t x = tile % tiles * 8 + in % 8, y = tile / tiles * 8 + in / 8;
            if (x >= size || y >= size || !covered || uniform(random) > 0.9) continue;
            shader::Patch patch{};
            patch.flags =
                (y * size + x) << shader::kTexelShift | (uniform(random) < 0.9 ? shader::kPatchSends : 0u);
            set.scene.texelToPatch[y * size + x] = static_cast<uint32_t>(set.scene.patches.size());
            set.scene.patches.push_back(patch);
            set.scene.patchChart.push_back(static_cast<uint32_t>(uniform(random) * 4));
            set.coverCells.push_back(random() & random() & random() & shader::kCoverCells);
        }
    }
    set.count = static_cast<uint32_t>(set.scene.patches.size());
    while (set.scene.patches.size() % shader::kChunk != 0)
        set.scene.patches.emplace_back();
    set.scene.patchChart.resize(set.scene.patches.size(), shader::kNoPatch);
    set.coverCells.resize(set.scene.patches.size(), 0);
    return set;
}

struct Texel {
    double light = 0, coverage = 0;
};

// Does what a device does with a plan: writes all patches, then fills ring by ring of the given chunks.
void follow(const PatchSet& set, const SeamPlan& plan, const std::vector<uint32_t>& chunks,
            const std::vector<glm::vec4>& light, std::vector<Texel>& texels) {
    const std::vector<uint32_t> shown = shownTexels(set);
    for (uint32_t chunk : chunks)
        for (uint32_t i = chunk * shader::kChunk; i < (chunk + 1) * shader::kChunk; ++i)
            if (shown[i] != shader::kNoTexel) texels[shown[i]] = {double{light[i].x}, 1.0};
    const auto size = static_cast<int>(set.scene.size);
    for (uint32_t ring = 1; ring <= plan.rings; ++ring) {
        for (uint32_t chunk : chunks) {
            for (uint32_t f = plan.starts[plan.at(ring, chunk)]; f < plan.starts[plan.at(ring, chunk) + 1];
                 ++f) {
                const auto texel = static_cast<int>(plan.fills[f].x);
                double sum = 0;
                int count = 0;
                for (uint32_t n = 0; n < 8; ++n) {
                    if ((plan.fills[f].y >> n & 1u) == 0) continue;
                    const glm::ivec2 from = glm::ivec2(texel % size, texel / size) + shader::seamOffset(n);
                    sum += texels[static_cast<size_t>(from.y * size + from.x)].light;
                    ++count;
                }
                texels[static_cast<size_t>(texel)] = {sum / count, 0.5};
            }
        }
    }
}

void expectSame(const std::vector<Texel>& texels, const FloatImage& expected) {
    for (size_t t = 0; t < texels.size(); ++t) {
        ASSERT_EQ(float(texels[t].coverage), expected.planes[3][t]) << t;
        ASSERT_NEAR(texels[t].light, expected.planes[0][t], 1e-5) << t;
    }
}

std::vector<glm::vec4> randomLight(size_t count, uint32_t seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> uniform(0.0f, 4.0f);
    std::vector<glm::vec4> light(count);
    for (glm::vec4& l : light)
        l = glm::vec4(uniform(random));
    return light;
}

TEST(SeamPlan, FillsWhatMakeLightmapFills) {
    for (const auto& [size, share] : {std::pair(64u, 0.3), std::pair(37u, 0.6), std::pair(16u, 0.05)}) {
        for (uint32_t rings : {0u, 1u, 4u}) {
            const PatchSet set = randomPatches(size, share, size);
            const SeamPlan plan = buildSeamPlan(set, rings);
            std::vector<uint32_t> all;
            for (uint32_t c = 0; c < set.chunkCount(); ++c)
                all.push_back(c);
            const std::vector<glm::vec4> light = randomLight(set.scene.patches.size(), 7);
            std::vector<Texel> texels(size_t{size} * size);
            follow(set, plan, all, light, texels);
            const FloatImage alone = makeLightmap(set, light, {.sew = rings > 0, .dilate = rings});
            expectSame(texels, alone);
            for (const bool rtrad : {false, true}) { // on all cores it is the same
                LightmapDesc desc{.sew = rings > 0, .dilate = rings, .rtrad = rtrad};
                if (rtrad) desc.quantity = Quantity::Radiance;
                const FloatImage whole = rtrad ? makeLightmap(set, light, desc) : alone;
                WorkerPool pool(3);
                desc.pool = &pool;
                EXPECT_EQ(makeLightmap(set, light, desc).planes, whole.planes);
            }
        }
    }
}

// A row of texels: two of a chart, a gap, and one of another chart, of which `cells` are covered.
PatchSet twoCharts(uint32_t cells) {
    constexpr uint32_t kSize = 8;
    PatchSet set;
    set.scene.size = kSize;
    set.scene.texelToPatch.assign(size_t{kSize} * kSize, shader::kNoPatch);
    for (const uint32_t x : {2u, 3u, 5u}) {
        const uint32_t texel = 3 * kSize + x;
        set.scene.texelToPatch[texel] = static_cast<uint32_t>(set.scene.patches.size());
        shader::Patch patch{};
        patch.flags = texel << shader::kTexelShift | shader::kPatchSends;
        set.scene.patches.push_back(patch);
        set.scene.patchChart.push_back(x == 5 ? 1 : 0);
        set.coverCells.push_back(x == 5 ? cells : shader::kCoverCells);
    }
    set.count = 3;
    set.scene.patches.resize(shader::kChunk);
    set.scene.patchChart.resize(shader::kChunk, shader::kNoPatch);
    set.coverCells.resize(shader::kChunk, 0);
    return set;
}

float gapOf(const PatchSet& set) {
    std::vector<glm::vec4> light(set.scene.patches.size(), glm::vec4(1.0f));
    light[2] = glm::vec4(101.0f);
    const FloatImage image = makeLightmap(set, light, {});
    std::vector<Texel> texels(size_t{set.scene.size} * set.scene.size);
    follow(set, buildSeamPlan(set, 4), {0}, light, texels);
    expectSame(texels, image);
    return image.planes[0][3 * set.scene.size + 4];
}

// Bilinear filters read no farther than a texel from where a chart ends.
TEST(SeamPlan, ATexelBetweenTwoChartsIsOfThatForWhichFiltersReadIt) {
    constexpr uint32_t kRightHalf = 0b11000'11000'11000'11000'11000, kLeftColumn = kRightHalf >> 3 & 0b1u;
    EXPECT_EQ(gapOf(twoCharts(kRightHalf)), 1.0f) << "the narrow chart ends on its texel's middle";
    EXPECT_EQ(gapOf(twoCharts(kLeftColumn)), 51.0f) << "both are read there";
    EXPECT_EQ(gapOf(twoCharts(0)), 51.0f) << "nobody knows";
    // Where the gap is a part of the first chart that lies inside something, it is filled from that chart.
    PatchSet inside = twoCharts(kLeftColumn);
    shader::Patch hidden{};
    hidden.flags = (3 * inside.scene.size + 4) << shader::kTexelShift;
    inside.scene.patches[3] = hidden;
    inside.scene.patchChart[3] = 0;
    inside.scene.texelToPatch[3 * inside.scene.size + 4] = 3;
    EXPECT_EQ(gapOf(inside), 1.0f);
    inside.scene.patchChart[3] = 1;
    EXPECT_EQ(gapOf(inside), 101.0f);
}

// Pages lie side by side, but no page's empty texels are filled from another one.
TEST(SeamPlan, NoPageFillsAnother) {
    PatchSet set = randomPatches(48, 0.3, 5);
    set.scene.mesh.pages = {9}; // of 16 texels
    const SeamPlan plan = buildSeamPlan(set, 4);
    std::vector<uint32_t> all;
    for (uint32_t c = 0; c < set.chunkCount(); ++c)
        all.push_back(c);
    const std::vector<glm::vec4> light = randomLight(set.scene.patches.size(), 7);
    std::vector<Texel> texels(size_t{48} * 48);
    follow(set, plan, all, light, texels);
    const FloatImage paged = makeLightmap(set, light, {});
    expectSame(texels, paged);
    for (uint32_t page = 0; page < 9; ++page) {
        // With the light of one page alone, that page is the same, and the others are black.
        std::vector<glm::vec4> own(light.size(), glm::vec4(0.0f));
        const auto pageOf = [](size_t texel) { return texel / 48 / 16 * 3 + texel % 48 / 16; };
        for (size_t t = 0; t < set.scene.texelToPatch.size(); ++t)
            if (const uint32_t patch = set.scene.texelToPatch[t];
                patch != shader::kNoPatch && pageOf(t) == page)
                own[patch] = light[patch];
        const FloatImage alone = makeLightmap(set, own, {});
        for (size_t t = 0; t < texels.size(); ++t)
            ASSERT_EQ(alone.planes[0][t], pageOf(t) == page ? paged.planes[0][t] : 0.0f) << page << " " << t;
    }
    set.scene.mesh.pages = {1};
    EXPECT_NE(makeLightmap(set, light, {}).planes, paged.planes) << "as one page, charts meet";
}

// After one chunk's light has changed, nothing but its own part of the plan is followed.
TEST(SeamPlan, FollowsOneChunkAtATime) {
    const PatchSet set = randomPatches(48, 0.4, 3);
    const SeamPlan plan = buildSeamPlan(set, 4);
    std::vector<glm::vec4> light = randomLight(set.scene.patches.size(), 1);
    const std::vector<glm::vec4> later = randomLight(set.scene.patches.size(), 2);
    std::vector<Texel> texels(size_t{48} * 48);
    std::vector<uint32_t> all;
    for (uint32_t c = 0; c < set.chunkCount(); ++c)
        all.push_back(c);
    follow(set, plan, all, light, texels);
    ASSERT_GT(set.chunkCount(), 6u);
    for (uint32_t chunk : {5u, 0u, set.chunkCount() - 1}) {
        for (uint32_t i = chunk * shader::kChunk; i < (chunk + 1) * shader::kChunk; ++i)
            light[i] = later[i];
        follow(set, plan, {chunk}, light, texels);
        expectSame(texels, makeLightmap(set, light, {}));
    }
}

TEST(SeamPlan, NamesATexelOncePerChunk) {
    const PatchSet set = randomPatches(48, 0.4, 3);
    const SeamPlan plan = buildSeamPlan(set, 4);
    ASSERT_EQ(plan.starts.size(), size_t{4} * set.chunkCount() + 1);
    for (size_t i = 0; i + 1 < plan.starts.size(); ++i) {
        std::set<uint32_t> once;
        for (uint32_t f = plan.starts[i]; f < plan.starts[i + 1]; ++f)
            once.insert(plan.fills[f].x);
        EXPECT_EQ(once.size(), plan.starts[i + 1] - plan.starts[i]);
    }
    EXPECT_EQ(plan.starts.back(), plan.fills.size());
}

} // namespace
} // namespace relume
