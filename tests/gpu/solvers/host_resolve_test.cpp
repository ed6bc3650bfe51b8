// Results that the CPU makes of sums are those of the device's kernels.
#include "tests/gpu/bake_scene.h"
#include "tests/gpu/gpu_environment.h"

#include <gtest/gtest.h>

namespace relume {
namespace {

// A hollow ball of which one side shines: what lights it is as far everywhere, so all of it is smoothed, and
// its normals turn from texel to texel.
Scene ball() {
    SceneMaker maker(64);
    const int grey = maker.material(0.5f), dark = maker.material(0.1f), bright = maker.material(0.3f, 5.0f);
    maker.sphere(glm::vec3(0.0f), 1.0f, {grey, dark, grey, grey, bright, grey}, 12);
    return maker.scene();
}

// A room with a board that stands on its floor, which parts the light on both of its sides.
Scene partedRoom() {
    SceneMaker maker(64);
    maker.box({0, 0, 0}, {2.0f * kX, 2.0f * kY, 2.0f * kZ}, maker.material(0.5f, 1.0f), 16);
    const int dark = maker.material(0.1f);
    maker.quad({0.9f, 0.3f, -0.1f}, 1.2f * kZ, 1.4f * kY, dark, {8, 8});
    maker.quad({1.0f, 0.3f, -0.1f}, 1.4f * kY, 1.2f * kZ, dark, {8, 8});
    return maker.scene();
}

void expectAlike(BakeDesc desc, const Scene& scene = ball()) {
    if (!testDevice().info().software()) GTEST_SKIP() << "the device makes results anyway";
    const Baked host = bakeScene(scene, desc);
    desc.deviceGather = true;
    const Baked device = bakeScene(scene, desc);
    EXPECT_LT(relativeError(host.lighting, device.lighting), 2e-5);
    EXPECT_NEAR(host.progress.localError95 / device.progress.localError95, 1.0, 1e-3);
    EXPECT_NEAR(host.progress.error / device.progress.error, 1.0, 1e-3);
    desc.smooth = false;
    EXPECT_GT(relativeError(bakeScene(scene, desc).lighting, device.lighting), 1e-3);
}

TEST(HostResolve, MakesWhatTheDeviceDoes) {
    expectAlike({.passes = 0, .method = Method::Hybrid, .samples = 16, .smooth = true});
}

TEST(HostResolve, MakesWhatTheDeviceDoesWhereChunksHaveSamplesOfTheirOwn) {
    expectAlike(
        {.passes = 0, .localError = 0.03, .perChunk = true, .method = Method::Hybrid, .smooth = true});
}

TEST(HostResolve, MakesWhatTheDeviceDoesWhereAWallPartsAFloor) {
    expectAlike({.passes = 0, .method = Method::Hybrid, .samples = 16, .smooth = true}, partedRoom());
}

TEST(HostResolve, MakesWhatTheDeviceDoesOfLayers) {
    expectAlike({.passes = 0, .method = Method::Hybrid, .samples = 16, .smooth = true, .layers = true});
}

} // namespace
} // namespace relume
