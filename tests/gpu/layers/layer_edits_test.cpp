// Edits of layers are held against fresh bakes of what they lead to.
#include "tests/gpu/gpu_environment.h"
#include "tests/gpu/layered.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace relume {

TEST(Layers, AMovedLightMakesItsOwnLayerAnew) {
    Layered bake(room());
    bake.finish();
    const Light4 plate = bake.layer(0), spot = bake.layer(2);
    const uint64_t rays = bake.progress().rays;
    bake.scene.lights[0].transform = at({0.7f, 0.5f, 1.2f});
    bake.edit();
    bake.finish();
    EXPECT_TRUE(sameBytes(bake.layer(0), plate));
    EXPECT_TRUE(sameBytes(bake.layer(2), spot));
    EXPECT_TRUE(sameBytes(bake.light(), freshLight(bake.scene)));
    // There are shadow rays to this light alone, as many as it has samples.
    const uint64_t patches = plate.size();
    EXPECT_GT(bake.progress().rays, rays);
    EXPECT_LE(bake.progress().rays - rays, patches * kQuick.samples);
}

TEST(Layers, UndoRestoresTheBytesWithoutARay) {
    Layered bake(room());
    bake.finish();
    const Light4 first = bake.light();
    const Scene before = bake.scene;
    bake.scene.lights[0].transform = at({0.7f, 0.5f, 1.2f});
    bake.edit();
    bake.finish();
    EXPECT_FALSE(sameBytes(bake.light(), first));
    const uint64_t rays = bake.progress().rays, pairs = bake.progress().pairs;
    bake.scene = before;
    bake.edit();
    bake.finish();
    EXPECT_TRUE(sameBytes(bake.light(), first));
    EXPECT_EQ(bake.progress().rays, rays);
    EXPECT_EQ(bake.progress().pairs, pairs);
}

TEST(Layers, ADeletedLightLeavesTheOthersAsTheyWere) {
    Layered bake(room());
    bake.finish();
    const Light4 first = bake.light(), panel = bake.layer(3);
    const uint64_t rays = bake.progress().rays;
    const Light bulb = bake.scene.lights[0];
    bake.scene.lights.erase(bake.scene.lights.begin());
    bake.edit();
    bake.finish();
    EXPECT_EQ(bake.progress().rays, rays);
    EXPECT_TRUE(sameBytes(bake.layer(2), panel));
    EXPECT_TRUE(sameBytes(bake.light(), freshLight(bake.scene)));
    bake.scene.lights.insert(bake.scene.lights.begin(), bulb);
    bake.edit();
    bake.finish();
    EXPECT_TRUE(sameBytes(bake.light(), first));
    EXPECT_EQ(bake.progress().rays, rays);
}

TEST(Layers, AnAddedLightIsAFreshBake) {
    Layered bake(room());
    bake.finish();
    bake.scene.lights.push_back(lightAt(LightType::Disc, {1.0f, 0.8f, 1.6f}, 30.0f, "Disc"));
    bake.scene.lights.back().radius = 0.2f;
    bake.edit();
    bake.finish();
    EXPECT_TRUE(sameBytes(bake.light(), freshLight(bake.scene)));
}

TEST(Layers, ASkyThatTurnsIsAFreshBake) {
    SceneMaker maker(32);
    maker.quad({-1, -1, 0}, 2.0f * kX, 2.0f * kY, maker.material(0.5f), glm::uvec2(16));
    maker.quad({0, -1, 0}, 1.0f * kZ, 2.0f * kY, maker.material(0.5f), glm::uvec2(8));
    Scene scene = maker.scene();
    scene.sky.radiance = glm::vec3(2.0f);
    scene.sky.width = 4;
    scene.sky.height = 2;
    scene.sky.file = "bright to one side";
    scene.sky.pixels = {glm::vec3(9), glm::vec3(1), glm::vec3(1), glm::vec3(1),
                        glm::vec3(1), glm::vec3(1), glm::vec3(1), glm::vec3(1)};
    BakeDesc desc = kQuick;
    desc.size = 32;
    Layered bake(scene, desc);
    bake.finish();
    const Light4 first = bake.light();
    bake.scene.sky.rotation = 1.5f;
    bake.edit();
    bake.finish();
    EXPECT_FALSE(sameBytes(bake.light(), first));
    EXPECT_TRUE(sameBytes(bake.light(), freshLight(bake.scene, desc)));
}

TEST(Layers, AColouredSurfaceGathersLinksAnewWithoutARay) {
    Layered bake(room());
    bake.finish();
    const uint64_t rays = bake.progress().rays;
    bake.scene.materials[0].baseColor = {0.9f, 0.2f, 0.1f, 1.0f};
    bake.edit();
    bake.finish();
    EXPECT_EQ(bake.progress().rays, rays);
    EXPECT_TRUE(sameBytes(bake.light(), freshLight(bake.scene)));
}

TEST(Layers, AColouredSurfaceIsSeenInAllLightsAtOnce) {
    BakeDesc desc = kQuick;
    desc.live = true;
    desc.smooth = false; // each layer has a width of its own
    Layered bake(room(), desc);
    bake.finish();
    EXPECT_TRUE(bake.solver().current());
    const Light4 before = bake.light();
    const uint64_t rays = bake.progress().rays;
    for (const float green : {0.2f, 0.5f}) {
        bake.scene.materials[0].baseColor = {0.8f, green, 0.1f, 1.0f};
        bake.edit();
        EXPECT_FALSE(bake.solver().current());
        while (!bake.solver().current())
            bake.solver().step();
        const auto& layers = bake.solver().layers();
        EXPECT_TRUE(
            std::none_of(layers.begin(), layers.end(), [](const auto& layer) { return layer->has(); }));
    }
    const Light4 atOnce = bake.light();
    // A weight counts in it, too.
    bake.scene.lights[0].intensity *= 2.0f;
    bake.edit();
    while (!bake.solver().current())
        bake.solver().step();
    const Light4 stronger = bake.light();
    bake.finish();
    EXPECT_EQ(bake.progress().rays, rays);
    const Light4 after = bake.light();
    EXPECT_TRUE(sameBytes(after, freshLight(bake.scene, desc)));
    EXPECT_LT(distance(stronger, after), 1e-3) << "of the same links";
    EXPECT_GT(distance(before, after), 0.1);
    EXPECT_GT(distance(atOnce, after), 0.05);
}

// While layers follow a colour, lights are dragged and dimmed: what is shown keeps up and does not go back to
// the colour before.
TEST(Layers, WhileAllAreSeenAtOnceLightsAreEditedAsEver) {
    BakeDesc desc = kQuick;
    desc.live = true;
    desc.batchMs = 1.0;
    Layered bake(room(), desc);
    bake.finish();
    const Light4 before = bake.light();
    bake.scene.materials[0].baseColor = {0.1f, 0.1f, 0.1f, 1.0f};
    bake.edit();
    while (!bake.solver().current())
        bake.solver().step();
    const double off = 0.7 * distance(before, bake.light());
    const auto seen = [&] {
        const uint64_t from = bake.solver().liveLight().version;
        for (int i = 0; i < 2000 && bake.solver().liveLight().version == from; ++i) {
            bake.editNow(); // each step is a frame in which the mouse was moved
            bake.solver().step();
            EXPECT_GT(distance(before, bake.light()), off);
        }
        return bake.solver().liveLight().version != from;
    };
    for (int i = 0; i < 3; ++i) {
        bake.scene.lights[0].transform = at({0.3f + 0.1f * i, 0.5f, 1.2f});
        EXPECT_TRUE(seen()) << "a light that is moved";
        bake.scene.lights[1].intensity *= 0.9f;
        EXPECT_TRUE(seen()) << "a light that is dimmed";
    }
    bake.scene.lights.push_back(lightAt(LightType::Point, {0.3f, 1.5f, 1.5f}, 1.0f, "New"));
    EXPECT_TRUE(seen()) << "a light that is added";
    bake.scene.lights.push_back(lightAt(LightType::Point, {1.7f, 0.3f, 1.5f}, 1.0f, "Newer"));
    uint64_t version = bake.solver().liveLight().version, versions = 0;
    for (int i = 0; i < 400; ++i) { // and a light that is dragged on and on
        bake.scene.lights[0].transform = at({0.3f + 0.002f * i, 0.5f, 1.2f});
        bake.editNow();
        bake.solver().step();
        const uint64_t now = bake.solver().liveLight().version;
        versions += now != version;
        version = now;
    }
    EXPECT_GT(versions, 3u);
    bake.scene.lights.erase(bake.scene.lights.begin());
    EXPECT_TRUE(seen()) << "a light that is deleted";
    while (!bake.solver().done()) {
        bake.solver().step();
        EXPECT_TRUE(bake.solver().liveLight().complete);
        EXPECT_GT(distance(before, bake.light()), off);
    }
    EXPECT_TRUE(sameBytes(bake.light(), freshLight(bake.scene, desc)));
}

TEST(Layers, ALightUnmutedWhileAllAreSeenAtOnceIsBaked) {
    BakeDesc desc = kQuick;
    desc.live = true;
    Layered bake(room(), desc);
    bake.edit({.muted = {{LightKey::Kind::Lamp, 0, 0}}, .solo = {}});
    bake.finish();
    bake.scene.materials[0].baseColor.g = 0.2f;
    bake.edit({.muted = {{LightKey::Kind::Lamp, 0, 0}}, .solo = {}});
    while (!bake.solver().current())
        bake.solver().step();
    bake.solver().step(); // a layer is under way
    bake.editNow();
    bake.finish();
    EXPECT_TRUE(sameBytes(bake.light(), freshLight(bake.scene, desc)));
}

TEST(Layers, MuteAndSoloWeighLightsWithNothing) {
    Layered bake(room());
    bake.finish();
    const uint64_t pairs = bake.progress().pairs;
    const LightKey bulb{LightKey::Kind::Lamp, 0, 0};
    bake.edit({.muted = {}, .solo = {bulb}});
    const Light4 alone = bake.light();
    const Light4 layer = bake.layer(1);
    for (size_t i = 0; i < alone.size(); ++i)
        ASSERT_FLOAT_EQ(alone[i].g, 3.0f * layer[i].g);
    bake.edit({.muted = {bulb}, .solo = {}});
    Scene without = bake.scene;
    without.lights.erase(without.lights.begin());
    EXPECT_TRUE(sameBytes(bake.light(), freshLight(without)));
    bake.finish();
    EXPECT_EQ(bake.progress().pairs, pairs);
}

TEST(Layers, ALightOfNoIntensityWaitsUntilItShines) {
    Scene scene = room();
    scene.lights[0].intensity = 0.0f;
    Layered bake(scene);
    bake.finish();
    EXPECT_FALSE(bake.solver().layers()[1]->has());
    bake.scene.lights[0].intensity = 2.0f;
    bake.edit();
    bake.finish();
    EXPECT_TRUE(bake.solver().layers()[1]->has());
    EXPECT_TRUE(sameBytes(bake.light(), freshLight(bake.scene)));
}

TEST(Layers, ALightInsideAWallIsDark) {
    Scene scene = room();
    scene.lights[0].transform = at({1.0f, 1.0f, -0.5f}); // below the floor
    scene.lights[0].radius = 0.0f;
    Layered bake(scene);
    bake.finish();
    for (const glm::vec4& v : bake.layer(1))
        ASSERT_EQ(glm::vec3(v), glm::vec3(0.0f));
    EXPECT_TRUE(bake.solver().layers()[1]->plan.converged);
}

// A light is dragged: each edit comes before the one before was followed to its end.
TEST(Layers, ALightThatIsDraggedIsSeenAndEndsAsAFreshBake) {
    BakeDesc desc = kQuick;
    desc.batchMs = 1.0;
    desc.live = true;
    Layered bake(room(), desc);
    bake.finish();
    uint64_t version = bake.solver().liveLight().version, seen = 0;
    for (int i = 0; i < 300; ++i) {
        bake.scene.lights[0].transform = at({0.3f + 0.004f * i, 0.5f, 1.2f});
        bake.editNow();
        bake.solver().step();
        const LiveLight live = bake.solver().liveLight();
        EXPECT_TRUE(live.complete) << "what was shown stays until there is more";
        seen += live.version != version;
        version = live.version;
    }
    EXPECT_GT(seen, 3u);
    bake.finish();
    EXPECT_TRUE(sameBytes(bake.light(), freshLight(bake.scene, desc)));
}

TEST(Layers, WithoutItsLastLightAPictureIsDark) {
    BakeDesc desc = kQuick;
    desc.live = true;
    SceneMaker maker(32);
    maker.quad({0, 0, 0}, 2.0f * kX, 2.0f * kY, maker.material(0.5f), glm::uvec2(16));
    Scene scene = maker.scene();
    scene.lights.push_back(lightAt(LightType::Point, {1.0f, 1.0f, 1.0f}, 3.0f, "Bulb"));
    Layered bake(scene, desc);
    bake.finish();
    const auto shown = [&] {
        const LiveLight live = bake.solver().liveLight();
        return vk::readBuffer<glm::vec4>(testDevice(), *live.light, bake.patches().scene.patches.size());
    };
    EXPECT_GT(meanOf(shown()), 0.0);
    bake.scene.lights.clear();
    bake.editNow();
    bake.finish();
    EXPECT_EQ(meanOf(shown()), 0.0);
}

// Makes a hundred edits, most of which come before the one before was followed to its end, and undoes them
// all.
void editAndUndo(const BakeDesc& desc) {
    Layered bake(room(), desc);
    bake.finish();
    const Light4 first = bake.light();
    const Scene start = bake.scene;
    std::mt19937 random(3);
    std::uniform_real_distribution<float> number(0.2f, 1.8f);
    std::vector<Scene> former;
    for (int i = 0; i < 100; ++i) {
        former.push_back(bake.scene);
        std::vector<Light>& lights = bake.scene.lights;
        switch (random() % 6) {
        case 0:
            if (!lights.empty()) lights[random() % lights.size()].intensity *= number(random);
            break;
        case 1:
            if (!lights.empty())
                lights[random() % lights.size()].transform =
                    at({number(random), number(random), number(random)});
            break;
        case 2:
            if (!lights.empty()) lights.erase(lights.begin() + static_cast<long>(random() % lights.size()));
            break;
        case 3:
            lights.push_back(lightAt(LightType::Point, {number(random), number(random), 1.0f}, 1.0f, "New"));
            break;
        case 4:
            bake.scene.materials[random() % bake.scene.materials.size()].baseColor.g = 0.5f * number(random);
            break;
        default:
            for (Material& material : bake.scene.materials)
                material.emission *= number(random);
        }
        bake.edit();
        for (uint32_t steps = random() % 12; steps > 0; --steps)
            bake.solver().step();
    }
    EXPECT_EQ(former.front().lights, start.lights);
    while (!former.empty()) {
        bake.scene = former.back();
        former.pop_back();
        bake.edit();
        if (random() % 4 == 0) bake.solver().step();
    }
    bake.finish();
    EXPECT_TRUE(sameBytes(bake.light(), first));
}

TEST(Layers, AHundredRandomEditsAreUndone) {
    editAndUndo(kQuick);
}

TEST(Layers, AHundredRandomEditsAreUndoneBeyondTheMemory) {
    BakeDesc desc = kQuick;
    desc.samples = 0;
    desc.error = 0.05;
    Layered bake(room(), desc);
    const uint64_t each = 2 * LightBuffers::lightBytes(bake.patches());
    desc.layerBytes = (bake.solver().layers().size() + 1) * each;
    editAndUndo(desc);
}

// Painted surfaces have the level of those before, which a fresh bake may never have.
TEST(Layers, ALayerThatWasDroppedComesBackWithItsBytes) {
    BakeDesc desc = kQuick;
    desc.samples = 0;
    desc.error = 0.03;
    Layered all(room(0.05f), desc);
    const size_t lights = all.solver().layers().size();
    desc.layerBytes = (lights + 1) * 2 * LightBuffers::lightBytes(all.patches());
    Layered bake(room(0.05f), desc);
    bake.finish();
    bake.scene.materials[0].baseColor = {0.95f, 0.95f, 0.95f, 1.0f};
    bake.edit();
    bake.finish();
    const Light4 painted = bake.light();
    const std::vector<Light> before = bake.scene.lights;
    for (const float along : {-0.3f, -0.6f}) {
        for (size_t i = 0; i < before.size(); ++i)
            bake.scene.lights[i].transform = at(glm::vec3(before[i].transform[3]) + along * kY);
        bake.edit();
        bake.finish();
    }
    const uint64_t rays = bake.progress().rays;
    bake.scene.lights = before;
    bake.edit();
    bake.finish();
    EXPECT_GT(bake.progress().rays, rays) << "they were dropped";
    EXPECT_TRUE(sameBytes(bake.light(), painted));
}

} // namespace relume
