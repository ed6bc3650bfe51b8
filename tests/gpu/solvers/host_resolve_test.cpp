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

void expectAlike(BakeDesc desc) {
    if (!testDevice().info().software()) GTEST_SKIP() << "the device makes results anyway";
    const Scene scene = ball();
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

TEST(HostResolve, MakesWhatTheDeviceDoesOfLayers) {
    expectAlike({.passes = 0, .method = Method::Hybrid, .samples = 16, .smooth = true, .layers = true});
}

} // namespace
} // namespace relume
