// Layers that bounce side by side on the device, as GPUs have it: each comes out as it does alone.
#include "tests/gpu/layered.h"

#include <gtest/gtest.h>

#include <random>

namespace relume {
namespace {

BakeDesc onDevice(BakeDesc desc = kQuick) {
    desc.deviceGather = true;
    return desc;
}

// A fresh bake makes layer after layer, for each needs direct light of its own first; what changes surfaces
// leaves that, and four bounce at a time.
void expectRecolouredAsFresh(const BakeDesc& desc, const std::vector<Light>& more = {}) {
    Scene scene = room();
    scene.lights.insert(scene.lights.end(), more.begin(), more.end());
    Layered bake(scene, desc);
    bake.finish();
    const uint64_t rays = bake.progress().rays, passes = bake.progress().passes;
    bake.scene.materials[0].baseColor = {0.3f, 0.7f, 0.5f, 1.0f};
    bake.edit();
    bake.finish();
    const uint64_t traced = bake.progress().rays - rays, bounced = bake.progress().passes - passes;
    Layered fresh(bake.scene, desc);
    fresh.finish();
    if (desc.error == 0) {
        EXPECT_EQ(traced, 0u);
        EXPECT_LT(2 * bounced, fresh.progress().passes) << "they bounced alone";
    }
    ASSERT_EQ(bake.solver().layers().size(), fresh.solver().layers().size());
    for (size_t i = 0; i < bake.solver().layers().size(); ++i) {
        EXPECT_EQ(bake.solver().layers()[i]->level, fresh.solver().layers()[i]->level) << i;
        EXPECT_EQ(bake.solver().layers()[i]->error, fresh.solver().layers()[i]->error) << i;
        EXPECT_TRUE(sameBytes(bake.layer(i), fresh.layer(i))) << i;
    }
    EXPECT_TRUE(sameBytes(bake.light(), fresh.light()));
}

} // namespace

TEST(LayerBounces, FourSideBySideAreEachAFreshBake) {
    expectRecolouredAsFresh(onDevice());
}

// The last ones have idle places beside them.
TEST(LayerBounces, SixAreEachAFreshBake) {
    Light far = lightAt(LightType::Point, {0.3f, 1.8f, 0.2f}, 1.0f, "Far");
    Light sun = lightAt(LightType::Directional, {1.0f, 1.0f, 1.9f}, 5.0f, "Sun"); // which a closed room hides
    expectRecolouredAsFresh(onDevice(), {far, sun});
}

TEST(LayerBounces, OfACountOfPassesAreEachAFreshBake) {
    for (const uint32_t passes : {2u, 4u}) {
        BakeDesc desc = onDevice();
        desc.passes = passes;
        expectRecolouredAsFresh(desc);
    }
}

TEST(LayerBounces, OfOneRoundOfLinksAreEachAFreshBake) {
    BakeDesc desc = onDevice();
    desc.samples = 16;
    expectRecolouredAsFresh(desc);
}

// One of those under way is another one now, the others go on.
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

// To the error that is asked for, levels and all.
TEST(LayerBounces, ToAnErrorAreEachAFreshBake) {
    BakeDesc desc = onDevice();
    desc.samples = 0;
    desc.error = 0.03;
    expectRecolouredAsFresh(desc);
}

} // namespace relume
