// Charts that cover no texel centre get one patch each. Here is where that is shown, and of which colour and
// area it is.
#include "bake/output/lightmap.h"
#include "bake/surface/patches.h"

#include "assets/atlas/lightmap_atlas.h"

#include <gtest/gtest.h>

#include <tuple>
#include <vector>

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

TextureGroup emptyGroup() {
    TextureGroup group;
    group.size = kThinMap;
    group.window = {0, 0, kThinMap, kThinMap};
    for (auto* plane : {&group.pos, &group.nrm, &group.mat, &group.emission})
        plane->resize(group.window.size());
    group.triangle.resize(group.window.size());
    return group;
}

// Gives the slivers of a scene one material with a texture of these texels in a row.
void paintSlivers(Scene& scene, const std::vector<glm::u8vec4>& texels) {
    Image image{"paint", static_cast<uint32_t>(texels.size()), 1, {}};
    for (const glm::u8vec4& t : texels)
        image.rgba.insert(image.rgba.end(), {t.r, t.g, t.b, t.a});
    scene.images = {image};
    scene.textures = {{.image = 0, .wrapS = Wrap::ClampToEdge, .wrapT = Wrap::ClampToEdge}};
    Material material;
    material.metallic = 0.0f;
    material.baseColorTexture.texture = 0;
    scene.materials = {material};
    for (Mesh& mesh : scene.meshes)
        mesh.primitives[0].material = 0;
}

PatchSet thinPatches(const Scene& scene) {
    return buildPatches(scene, flatten(scene, buildAtlas(scene, kThinMap)), emptyGroup(), {});
}

TEST(ThinCharts, HaveTheColourInTheMiddleOfTheirTriangle) {
    Scene scene;
    addSliver(scene, 2, 3, 0.1f);
    Primitive& sliver = scene.meshes[0].primitives[0];
    // Both triangles have corners 0 and 2; the first one has corner 1, too.
    sliver.colors = {{1, 0, 0, 1}, {0, 0.5f, 0, 1}, {0, 0, 0.25f, 1}, {0, 0, 0, 1}};
    const PatchSet set = thinPatches(scene);
    ASSERT_EQ(set.count, 1u);
    Material plain; // the default one is a metal
    const float diffuse = 1.0f - plain.metallic + 0.5f * plain.metallic * plain.roughness * plain.roughness;
    EXPECT_NEAR(set.albedoPattern[0].r, diffuse / 3.0f, 1e-6);
    EXPECT_NEAR(set.albedoPattern[0].g, diffuse * 0.5f / 3.0f, 1e-6);
    EXPECT_NEAR(set.albedoPattern[0].b, diffuse * 0.25f / 3.0f, 1e-6);
}

TEST(ThinCharts, ReadTheirTextureAsItIsWrapped) {
    Scene scene;
    addSliver(scene, 2, 3, 0.1f);
    paintSlivers(scene, {{255, 255, 255, 255}, {0, 0, 0, 255}, {0, 0, 0, 255}, {0, 0, 0, 255}});
    for (const auto& [u, wrap, white] :
         {std::tuple(1.1f, Wrap::Repeat, true), std::tuple(1.1f, Wrap::ClampToEdge, false),
          std::tuple(1.1f, Wrap::MirroredRepeat, false), std::tuple(-0.1f, Wrap::Repeat, false),
          std::tuple(-0.1f, Wrap::ClampToEdge, true), std::tuple(-0.1f, Wrap::MirroredRepeat, true)}) {
        scene.textures[0].wrapS = wrap;
        scene.meshes[0].primitives[0].texCoord0.assign(4, glm::vec2(u, 0.5f));
        EXPECT_EQ(thinPatches(scene).albedoPattern[0].r, white ? 1.0f : 0.0f)
            << u << ", " << static_cast<uint32_t>(wrap);
    }
}

// The left half of the sliver is a hole whose texels are bright; of one that is all hole nothing is there.
TEST(ThinCharts, OfMaskedMaterialsAreThereAsFarAsTheyAreSolid) {
    Scene scene;
    addSliver(scene, 2, 3, 0.1f);
    const float whole = thinPatches(scene).scene.patches[0].area;
    paintSlivers(scene, {{255, 255, 255, 0}, {0, 255, 0, 255}});
    scene.materials[0].alphaMode = AlphaMode::Mask;
    Primitive& sliver = scene.meshes[0].primitives[0];
    sliver.texCoord0 = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    const PatchSet set = thinPatches(scene);
    ASSERT_EQ(set.count, 1u);
    EXPECT_NEAR(set.scene.patches[0].area, 0.5f * whole, 0.03f * whole);
    EXPECT_NE(set.scene.patches[0].flags & shader::kPatchThin, 0u);
    EXPECT_EQ(glm::vec3(set.albedoPattern[0]), glm::vec3(0, 1, 0));
    const float middle = 0.5f * (sliver.positions[0].x + sliver.positions[1].x);
    EXPECT_GT(set.scene.patches[0].position.x, middle);
    EXPECT_LT(set.scene.patches[0].position.x, sliver.positions[1].x);

    sliver.texCoord0.assign(4, glm::vec2(0.1f));
    addSliver(scene, 5, 3, 0.1f); // a lightmap without any patch is an error
    EXPECT_EQ(thinPatches(scene).count, 1u);
}

} // namespace
} // namespace relume
