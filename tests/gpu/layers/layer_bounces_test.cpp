// Layers bounce side by side on the device, as on GPUs; each comes out as it does alone.
#include "tests/gpu/layered.h"

#include <gtest/gtest.h>

#include <random>

namespace relume {
namespace {

BakeDesc onDevice(BakeDesc desc = kQuick) {
    desc.deviceGather = true;
    return desc;
}

// Bakes each light by itself, while no other one shines.
void bakeOneByOne(Layered& bake) {
    for (const LightSource& source : lightSources(bake.scene)) {
        bake.edit({.muted = {}, .solo = {source.key}});
        bake.finish();
    }
    bake.edit();
    bake.finish();
}

void expectSameLayers(Layered& bake, Layered& alone) {
    ASSERT_EQ(bake.solver().layers().size(), alone.solver().layers().size());
    for (size_t i = 0; i < bake.solver().layers().size(); ++i) {
        EXPECT_EQ(bake.solver().layers()[i]->level, alone.solver().layers()[i]->level) << i;
        EXPECT_EQ(bake.solver().layers()[i]->error, alone.solver().layers()[i]->error) << i;
        EXPECT_TRUE(sameBytes(bake.layer(i), alone.layer(i))) << i;
    }
    EXPECT_TRUE(sameBytes(bake.light(), alone.light()));
}

// From the start, layers bounce together once each has its direct light; an edit of surfaces keeps that, so
// that they do at once.
void expectAsAlone(const BakeDesc& desc, const std::vector<Light>& more = {}) {
    Scene scene = room();
    scene.lights.insert(scene.lights.end(), more.begin(), more.end());
    Layered bake(scene, desc);
    bake.finish();
    const uint64_t rays = bake.progress().rays, read = bake.progress().linksRead;
    bake.scene.materials[0].baseColor = {0.3f, 0.7f, 0.5f, 1.0f};
    bake.edit();
    bake.finish();
    const uint64_t traced = bake.progress().rays - rays, readAgain = bake.progress().linksRead - read;
    Layered alone(bake.scene, desc);
    bakeOneByOne(alone);
    const bool fixed = desc.error == 0 && desc.layerError == 0;
    if (fixed) {
        EXPECT_EQ(traced, 0u);
        EXPECT_LT(2 * readAgain, alone.progress().linksRead) << "they bounced alone";
        EXPECT_LT(2 * read, alone.progress().linksRead) << "they bounced alone";
    }
    if (fixed)
        expectSameLayers(bake, alone);
    else // by other levels: each goes on from what it had in the other colour
        EXPECT_LT(distance(bake.light(), alone.light()), 2.0 * desc.layerError);
    Layered fresh(bake.scene, desc);
    fresh.finish();
    expectSameLayers(fresh, alone);
}

} // namespace

TEST(LayerBounces, FourSideBySideAreAsAlone) {
    expectAsAlone(onDevice());
}

// The last layers have idle places beside them.
TEST(LayerBounces, SixAreAsAlone) {
    Light far = lightAt(LightType::Point, {0.3f, 1.8f, 0.2f}, 1.0f, "Far");
    Light sun = lightAt(LightType::Directional, {1.0f, 1.0f, 1.9f}, 5.0f, "Sun"); // which a closed room hides
    expectAsAlone(onDevice(), {far, sun});
}

TEST(LayerBounces, OfACountOfPassesAreAsAlone) {
    for (const uint32_t passes : {2u, 4u}) {
        BakeDesc desc = onDevice();
        desc.passes = passes;
        expectAsAlone(desc);
    }
}

TEST(LayerBounces, OfOneSamplePassOfLinksAreAsAlone) {
    BakeDesc desc = onDevice();
    desc.samples = 16;
    expectAsAlone(desc);
}

// One of the layers under way is replaced; the others go on.
TEST(LayerBounces, AnEditAmongThemLeavesTheOthers) {
    Layered bake(room(), onDevice());
    bake.finish();
    std::mt19937 random(7);
    for (int edit = 0; edit < 12; ++edit) {
        bake.scene.materials[0].baseColor.r = 0.2f + 0.05f * static_cast<float>(edit);
        bake.edit();
        for (uint32_t k = random() % 6; k > 0 && !bake.solver().done(); --k)
            bake.solver().step();
        Light& light = bake.scene.lights[random() % 3];
        light.transform[3].x = 0.4f + 0.1f * static_cast<float>(edit);
        bake.edit();
        for (uint32_t k = random() % 6; k > 0 && !bake.solver().done(); --k)
            bake.solver().step();
        if (edit % 3 == 2) std::swap(bake.scene.lights[0], bake.scene.lights[2]);
        if (edit % 4 == 3) bake.scene.lights.erase(bake.scene.lights.begin());
        if (edit % 4 == 3)
            bake.scene.lights.push_back(lightAt(LightType::Point, {1.0f, 0.4f, 1.0f}, 2.0f, "New"));
        bake.edit();
    }
    bake.finish();
    EXPECT_TRUE(sameBytes(bake.light(), freshLight(bake.scene, onDevice())));
}

// Layers go to the error that is asked for each, levels and all. To the composite's they would not: one that
// is soloed is the composite.
TEST(LayerBounces, ToAnErrorAreAsAlone) {
    BakeDesc desc = onDevice();
    desc.samples = 0;
    desc.error = 0;
    desc.layerError = 0.03;
    expectAsAlone(desc);
}

} // namespace relume
