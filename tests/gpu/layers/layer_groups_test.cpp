// Here lights share layers, for there is no memory to tell all of them apart.
#include "assets/atlas/lightmap_atlas.h"
#include "tests/gpu/layered.h"

#include <gtest/gtest.h>

namespace relume {
namespace {

constexpr LightKey kBulb{LightKey::Kind::Lamp, 2, 0}, kPanel{LightKey::Kind::Lamp, 4, 0};

/// Makes a floor and two walls under a sky and two suns, with two plates that shine, a bulb, a spot, a panel
/// and a point, and a shelf: nine lights, of which six are in the light group where there is room for three
/// layers.
Scene yard() {
    SceneMaker maker(64);
    const int white = maker.material(0.6f);
    maker.quad({0, 0, 0}, 2.0f * kX, 2.0f * kY, white, glm::uvec2(24));
    maker.quad({0, 0, 0}, 2.0f * kZ, 2.0f * kX, white, glm::uvec2(16));
    maker.quad({0, 0, 0}, 2.0f * kY, 2.0f * kZ, white, glm::uvec2(16));
    maker.quad({0.6f, 0.6f, 1.9f}, 0.4f * kY, 0.4f * kX, maker.material(0.0f, 8.0f), glm::uvec2(4));
    maker.quad({1.4f, 0.6f, 1.5f}, 0.2f * kY, 0.2f * kX, maker.material(0.0f, 20.0f), glm::uvec2(4));
    maker.quad({1.2f, 0.3f, 0.7f}, 0.5f * kX, 0.9f * kY, maker.material(0.3f), glm::uvec2(8));
    Scene scene = maker.scene();
    const auto add = [&](LightType type, glm::vec3 position, float intensity, const char* name) -> Light& {
        scene.lights.push_back(lightAt(type, position, intensity, name));
        return scene.lights.back();
    };
    add(LightType::Directional, {}, 4.0f, "Sun").angle = 0.02f;
    add(LightType::Directional, {}, 1.0f, "Moon").color = {0.5f, 0.7f, 1.0f};
    add(LightType::Point, {1.5f, 1.5f, 1.5f}, 3.0f, "Bulb").radius = 0.1f;
    add(LightType::Spot, {0.4f, 1.2f, 1.8f}, 9.0f, "Spot").color = {0.2f, 0.5f, 1.0f};
    add(LightType::Rectangle, {1.3f, 1.0f, 1.7f}, 20.0f, "Panel").size = {0.3f, 0.2f};
    add(LightType::Point, {0.5f, 0.5f, 0.4f}, 0.5f, "Candle");
    scene.sky.radiance = {0.2f, 0.3f, 0.5f};
    return scene;
}

/// Returns the memory for so many layers.
uint64_t bytesFor(const Scene& scene, uint32_t layers, uint32_t size = 64) {
    const std::unique_ptr<Baker> baker =
        makeBaker(scene, {.size = size, .passes = 0, .method = Method::Hybrid, .samples = 16});
    return layers * 2 * LightBuffers::lightBytes(baker->patches());
}

BakeDesc quick(const Scene& scene, uint32_t layers = 4) {
    return {.passes = 0,
            .method = Method::Hybrid,
            .samples = 32,
            .smooth = true,
            .layers = true,
            .layerBytes = bytesFor(scene, layers)};
}

std::string namesOf(LayerSolver& solver) {
    std::string names;
    for (const auto& layer : solver.layers())
        names += (names.empty() ? "" : ", ") + layer->source.name;
    return names;
}

void expectFresh(Layered& bake, const BakeDesc& desc, const char* what) {
    bake.finish();
    EXPECT_TRUE(sameBytes(bake.light(), freshLight(bake.scene, desc))) << what;
}

} // namespace

TEST(LayerGroups, SumToABakeWithALayerForEach) {
    const Scene scene = yard();
    BakeDesc desc = quick(scene);
    desc.samples = 0;
    desc.error = 0.01;
    Layered grouped(scene, desc);
    EXPECT_EQ(namesOf(grouped.solver()), "Sky, directional, rest");
    EXPECT_EQ(grouped.solver().layers()[2]->members.size(), 6u);
    grouped.finish();
    EXPECT_LE(grouped.progress().error, 0.01);
    desc.layerBytes = 0;
    Layered apart(scene, desc);
    EXPECT_EQ(apart.solver().layers().size(), 9u);
    apart.finish();
    EXPECT_LE(distance(grouped.light(), apart.light()), 0.02);
}

// Both are sums of the same samples, of which direct light alone is made: they differ by rounding.
TEST(LayerGroups, HoldTheLightOfTheirMembers) {
    Scene scene = yard();
    for (Material& material : scene.materials)
        material.emission = glm::vec3(0.0f);
    BakeDesc desc = quick(scene);
    desc.passes = 1;
    desc.allOver = false; // where one member has the edge of a shadow, all of a group are sampled more often
    Layered grouped(scene, desc);
    EXPECT_EQ(namesOf(grouped.solver()), "Sky, directional, rest");
    grouped.finish();
    desc.layerBytes = 0;
    Layered apart(scene, desc);
    apart.finish();
    EXPECT_LE(distance(grouped.light(), apart.light()), 1e-6);
}

TEST(LayerGroups, AnEditOfAMemberIsAFreshBakeAndLeavesOtherLayers) {
    const Scene start = yard();
    const BakeDesc desc = quick(start);
    Layered bake(start, desc);
    bake.finish();
    const Light4 first = bake.light(), sky = bake.layer(0), suns = bake.layer(1);
    std::vector<Light>& lights = bake.scene.lights;
    lights[2].color = {1.0f, 0.4f, 0.1f};
    bake.edit();
    EXPECT_EQ(staleReason(*bake.solver().layers()[2]), "");
    bake.solver().step();
    EXPECT_EQ(staleReason(*bake.solver().layers()[2]), "light 'Bulb' in 'rest' changed");
    expectFresh(bake, desc, "colour");
    lights[4].transform = at({0.7f, 1.1f, 1.3f});
    bake.edit();
    expectFresh(bake, desc, "place");
    bake.scene.materials[1].emission *= 0.3f;
    bake.edit();
    expectFresh(bake, desc, "emission");
    lights.erase(lights.begin() + 3);
    bake.edit();
    expectFresh(bake, desc, "deleted");
    EXPECT_TRUE(sameBytes(bake.layer(0), sky));
    EXPECT_TRUE(sameBytes(bake.layer(1), suns));
    bake.scene = start;
    bake.edit();
    bake.finish();
    EXPECT_TRUE(sameBytes(bake.light(), first)) << "all undone";
}

TEST(LayerGroups, ALayerOfOneLightIsAsWithoutGroups) {
    const Scene scene = yard();
    BakeDesc desc = quick(scene);
    Layered grouped(scene, desc);
    grouped.finish();
    desc.layerBytes = 0;
    Layered apart(scene, desc);
    apart.finish();
    EXPECT_TRUE(sameBytes(grouped.layer(0), apart.layer(8)));
}

TEST(LayerGroups, AMutedMemberMakesItsGroupAnewAndIsShownUntilThen) {
    const Scene start = yard();
    const BakeDesc desc = quick(start);
    Layered bake(start, desc);
    bake.finish();
    const Light4 first = bake.light();
    bake.edit({.muted = {kBulb}, .solo = {}});
    EXPECT_TRUE(sameBytes(bake.light(), first));
    bake.finish();
    EXPECT_FALSE(sameBytes(bake.light(), first));
    Scene without = start;
    without.lights[2].intensity = 0.0f;
    EXPECT_TRUE(sameBytes(bake.light(), freshLight(without, desc)));
}

TEST(LayerGroups, AnEditThatIsTakenBackBeforeItsTurnCostsNothing) {
    const Scene start = yard();
    const BakeDesc desc = quick(start);
    Layered bake(start, desc);
    bake.finish();
    const Light4 group = bake.layer(2);
    const uint64_t rays = bake.progress().rays;
    bake.scene.sky.rotation = 1.0f; // its turn is first
    bake.edit({.muted = {kBulb, kPanel}, .solo = {}});
    bake.solver().step();
    EXPECT_EQ(staleReason(*bake.solver().layers()[2]), "light 'Bulb' in 'rest' is off");
    bake.edit();
    bake.finish();
    EXPECT_TRUE(sameBytes(bake.layer(2), group));
    EXPECT_LE(bake.progress().rays - rays, uint64_t{group.size()} * desc.samples) << "the sky's alone";
}

TEST(LayerGroups, AGroupThatIsOffTakesNoRayAndComesBackAtOnce) {
    const Scene start = yard();
    Layered bake(start, quick(start));
    bake.finish();
    const Light4 first = bake.light();
    const uint64_t rays = bake.progress().rays, pairs = bake.progress().pairs;
    const LightMix sky{.muted = {}, .solo = {{LightKey::Kind::Sky, 0, 0}}};
    bake.edit(sky);
    const Light4 alone = bake.light(), layer = bake.layer(0);
    for (size_t i = 0; i < alone.size(); ++i)
        ASSERT_FLOAT_EQ(alone[i].b, 0.5f * layer[i].b);
    bake.finish();
    EXPECT_TRUE(sameBytes(bake.light(), alone));
    bake.edit();
    bake.finish();
    EXPECT_TRUE(sameBytes(bake.light(), first));
    EXPECT_EQ(bake.progress().rays, rays);
    EXPECT_EQ(bake.progress().pairs, pairs);
}

TEST(LayerGroups, ColoursOfSurfacesAreAFreshBakeWithoutARay) {
    const Scene start = yard();
    const BakeDesc desc = quick(start);
    Layered bake(start, desc);
    bake.finish();
    const uint64_t rays = bake.progress().rays;
    bake.scene.materials[0].baseColor = {0.9f, 0.2f, 0.1f, 1.0f};
    bake.edit();
    expectFresh(bake, desc, "colour");
    EXPECT_EQ(bake.progress().rays, rays);
}

TEST(LayerGroups, AnObjectThatMovesIsAFreshBake) {
    const Scene start = yard();
    const BakeDesc desc = quick(start);
    Layered bake(start, desc);
    bake.finish();
    const LightmapAtlas atlas = buildAtlas(start, desc.size);
    for (const size_t instance : {5u, 4u}) { // the shelf, a plate that shines
        bake.scene.instances[instance].transform = at({-0.2f, 0.1f, 0.05f});
        bake.editNow({}, &atlas);
        expectFresh(bake, desc, "moved");
    }
}

TEST(LayerGroups, AGroupThatWasOffWhileAnObjectMovedIsAFreshBake) {
    const Scene start = yard();
    const BakeDesc desc = quick(start);
    Layered bake(start, desc);
    bake.finish();
    const LightMix sky{.muted = {}, .solo = {{LightKey::Kind::Sky, 0, 0}}};
    bake.edit(sky);
    bake.finish();
    bake.scene.instances[5].transform = at({-0.2f, 0.1f, 0.05f});
    const LightmapAtlas atlas = buildAtlas(start, desc.size);
    bake.editNow(sky, &atlas);
    bake.finish();
    bake.edit();
    expectFresh(bake, desc, "on again");
}

TEST(LayerGroups, LightsBeyondTheMemoryAreGroupedAndTakenApartAgain) {
    Scene start = yard();
    start.lights.resize(2); // with sky and plates 5
    const BakeDesc desc = quick(start, 5);
    Layered bake(start, desc);
    EXPECT_EQ(bake.solver().layers().size(), 5u);
    bake.finish();
    const Light4 first = bake.light();
    bake.scene.lights.push_back(lightAt(LightType::Point, {1.0f, 0.8f, 1.6f}, 2.0f, "New"));
    EXPECT_TRUE(bake.solver().holds(bake.scene.lights.size()));
    bake.edit();
    bake.solver().step();
    EXPECT_EQ(namesOf(bake.solver()), "surface 3, Sky, directional, rest");
    EXPECT_LT(distance(bake.light(), first), 1e-6) << "till they are there";
    bake.finish();
    const Light4 more = bake.light();
    EXPECT_TRUE(sameBytes(more, freshLight(bake.scene, desc)));
    bake.scene.lights.pop_back();
    bake.edit();
    bake.solver().step();
    EXPECT_EQ(bake.solver().layers().size(), 5u);
    EXPECT_LT(distance(bake.light(), more), 1e-6) << "till they are there";
    bake.finish();
    EXPECT_EQ(bake.solver().layers().size(), 5u);
    EXPECT_TRUE(sameBytes(bake.light(), first));
}

TEST(LayerGroups, FiveHundredLightsShareThreeLayers) {
    SceneMaker maker(32);
    maker.quad({-1, -1, 0}, 2.0f * kX, 2.0f * kY, maker.material(0.5f), glm::uvec2(12));
    maker.quad({0, -1, 0}, 1.0f * kZ, 2.0f * kY, maker.material(0.5f), glm::uvec2(8));
    Scene scene = maker.scene();
    for (int i = 0; i < 500; ++i) {
        const glm::vec3 place(-0.95f + 0.1f * static_cast<float>(i % 20), -0.95f + 0.07f * (i / 20.0f), 0.8f);
        scene.lights.push_back(lightAt(LightType::Point, place, 0.01f, "Lamp " + std::to_string(i)));
        if (i % 50 == 0) scene.lights.back().radius = 0.02f;
    }
    BakeDesc desc{.size = 32,
                  .passes = 0,
                  .method = Method::Hybrid,
                  .samples = 16,
                  .layers = true,
                  .layerBytes = bytesFor(scene, 4, 32)};
    Layered bake(scene, desc);
    EXPECT_EQ(namesOf(bake.solver()), "Lamp 0, Lamp 1, rest");
    bake.finish();
    desc.layerBytes = 0;
    Layered apart(scene, desc);
    apart.finish();
    EXPECT_LE(distance(bake.light(), apart.light()), 0.01);
}

} // namespace relume
