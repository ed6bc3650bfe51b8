// Charts that cover no texel centre get one patch each. Here is where that is shown.
#include "bake/output/lightmap.h"
#include "bake/surface/patches.h"

#include "assets/atlas/lightmap_atlas.h"

#include <gtest/gtest.h>

namespace relume {
namespace {

constexpr uint32_t kThinMap = 8;

/// A sliver beside the centre of the texel (x, y), as a mesh of its own.
void addSliver(Scene& scene, float x, float y, float inset) {
    Primitive sliver;
    const float left = (x + inset) / kThinMap, right = (x + inset + 0.1f) / kThinMap;
    const float low = (y + 0.6f) / kThinMap, high = (y + 0.9f) / kThinMap;
    sliver.texCoord1 = {{left, low}, {right, low}, {right, high}, {left, high}};
    for (const glm::vec2& uv : sliver.texCoord1)
        sliver.positions.emplace_back(uv, 0.0f);
    sliver.normals.assign(4, glm::vec3(0, 0, 1));
    sliver.indices = {0, 1, 2, 0, 2, 3};
    scene.instances.push_back({"Sliver", static_cast<int>(scene.meshes.size())});
    scene.meshes.push_back({"Sliver", {sliver}});
}

TEST(ThinCharts, AreShownWhereNoOtherPatchIs) {
    Scene scene;
    addSliver(scene, 2, 3, 0.1f); // alone in its texel
    addSliver(scene, 5, 3, 0.1f); // two in one texel: the first is shown
    addSliver(scene, 5, 3, 0.7f);
    addSliver(scene, 6, 6, 0.1f); // in a texel that another chart's patch has
    const WorldMesh mesh = flatten(scene, buildAtlas(scene, kThinMap));
    ASSERT_EQ(mesh.chartCount, 4u);
    TextureGroup group;
    group.size = kThinMap;
    group.window = {0, 0, kThinMap, kThinMap};
    group.pos.resize(group.window.size());
    group.nrm.resize(group.window.size(), glm::vec4(0, 0, 1, 0));
    group.mat.resize(group.window.size(), glm::vec4(1));
    group.emission.resize(group.window.size());
    group.triangle.resize(group.window.size());
    group.triangle[6 * kThinMap + 6] = 1; // the first sliver's triangle
    const PatchSet set = buildPatches(scene, mesh, group, {});
    const auto chartAt = [&](uint32_t x, uint32_t y) {
        const uint32_t patch = set.scene.texelToPatch[y * kThinMap + x];
        return patch == shader::kNoPatch ? kNoChart : set.scene.patchChart[patch];
    };
    EXPECT_EQ(chartAt(6, 6), mesh.chart[0]) << "a texel's own patch stays";
    EXPECT_EQ(chartAt(2, 3), kNoChart) << "the first sliver has a texel";
    EXPECT_EQ(chartAt(5, 3), mesh.chart[2]);
    EXPECT_EQ(set.count, 4u);

    // With no texel of its own, the first one is shown where it lies, in its own light.
    group.triangle[6 * kThinMap + 6] = 0;
    const PatchSet thin = buildPatches(scene, mesh, group, {});
    std::vector<glm::vec4> light(thin.scene.patches.size());
    for (size_t i = 0; i < light.size(); ++i)
        light[i] = glm::vec4(static_cast<float>(thin.scene.patchChart[i] + 1));
    const FloatImage image = makeLightmap(thin, light, {});
    const auto lightAt = [&](uint32_t x, uint32_t y) { return (*image.find("R"))[y * kThinMap + x]; };
    EXPECT_EQ(lightAt(2, 3), static_cast<float>(mesh.chart[0] + 1));
    EXPECT_EQ(lightAt(5, 3), static_cast<float>(mesh.chart[2] + 1));
    EXPECT_EQ(lightAt(6, 6), static_cast<float>(mesh.chart[6] + 1));
    EXPECT_EQ((*image.find("coverage"))[3 * kThinMap + 2], 1.0f);
}

} // namespace
} // namespace relume
