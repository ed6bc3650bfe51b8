// A sky that links bring must give the light that rays to it give.
#include "assets/images/metrics.h"
#include "bake/gather/sky_links.h"
#include "tests/gpu/bake_comparison.h"
#include "tests/gpu/bake_scene.h"
#include "tests/gpu/gpu_environment.h"
#include "tests/gpu/layered.h"

#include <gtest/gtest.h>

#include <cmath>

namespace relume {
namespace {

constexpr uint32_t kAtlasSize = 48;
constexpr float kRadiance = 3.0f; // [cd/m^2]

// A court, an arcade beside it and a deep room behind that: from open to the sky to hardly any of it.
Scene court() {
    SceneMaker maker(kAtlasSize);
    const int grey = maker.material(0.6f);
    maker.quad({0, 0, 0}, 8.0f * kX, 4.0f * kY, grey, {16, 8});
    maker.quad({0, 0, 0}, 4.0f * kY, 3.0f * kZ, grey, {8, 6});
    maker.quad({0, 4, 0}, 8.0f * kX, 3.0f * kZ, grey, {16, 6});
    maker.quad({8, 0, 0}, 3.0f * kZ, 4.0f * kY, grey, {6, 8});
    maker.quad({0, 0, 0}, 3.0f * kZ, 8.0f * kX, grey, {6, 16});
    maker.quad({3, 0, 3}, 4.0f * kY, 5.0f * kX, grey, {8, 10});
    maker.quad({5, 0, 0}, 2.6f * kY, 3.0f * kZ, grey, {6, 6});
    maker.quad({5, 0, 0}, 3.0f * kZ, 2.6f * kY, grey, {6, 6});
    Scene scene = maker.scene();
    scene.sky.radiance = glm::vec3(kRadiance);
    return scene;
}

BakeDesc precise(Method method, uint32_t samples) {
    return {.size = kAtlasSize, .passes = 0, .method = method, .samples = samples};
}

} // namespace

// The horizon is the geometric normal's, the cosine the shading normal's.
TEST(SkyLinks, ATiltedShadingNormalGetsTheSkyAboveTheHorizonAlone) {
    constexpr double kTilt = 0.9; // [rad]
    SceneMaker maker(32);
    const TexelRect rect = maker.quad({0, 0, 0}, kX, kY, maker.material(0.0f), {8, 8});
    Scene scene = maker.scene();
    for (glm::vec3& normal : scene.meshes.front().primitives.front().normals)
        normal = {static_cast<float>(std::sin(kTilt)), 0, static_cast<float>(std::cos(kTilt))};
    scene.sky.radiance = glm::vec3(kRadiance);
    const double lune = 0.5 * (1 + std::cos(kTilt));
    for (const TracerKind tracer : tracersOfTestDevice()) {
        BakeDesc desc = precise(Method::Hybrid, 4096);
        desc.size = 32;
        desc.tracer = tracer;
        const TexelStatistics all = statistics(bakeScene(scene, desc).lighting, rect);
        EXPECT_NEAR(all.mean / (kRadiance * lune), 1.0, 1e-3) << tracerName(tracer);
        EXPECT_NEAR(all.min / (kRadiance * lune), 1.0, 1e-2) << tracerName(tracer);
    }
}

// Rays are sent to a picture, and be it of one pixel.
TEST(SkyLinks, BringWhatRaysToTheSkyDo) {
    const Scene scene = court();
    Scene picture = scene;
    picture.sky.width = picture.sky.height = 1;
    picture.sky.pixels = {glm::vec3(1.0f)};
    for (const Method method : {Method::Directional, Method::Hybrid}) {
        const BakeDesc desc = precise(method, 4096);
        ASSERT_TRUE(linksSeeSky(scene.sky, settingsOf(desc).solver));
        ASSERT_FALSE(linksSeeSky(picture.sky, settingsOf(desc).solver));
        const Baked links = bakeScene(scene, desc), rays = bakeScene(picture, desc);
        EXPECT_LT(relativeError(links.lighting, rays.lighting), 0.02) << methodName(method);
        const TexelRect all{0, 0, kAtlasSize, kAtlasSize};
        EXPECT_NEAR(statistics(links.lighting, all).mean / statistics(rays.lighting, all).mean, 1.0, 1e-3);
        EXPECT_LT(links.progress.rays, 0.75 * static_cast<double>(rays.progress.rays));
    }
}

TEST(SkyLinks, DeviceGathersWhatTheHostDoes) {
    if (!testDevice().info().software()) GTEST_SKIP() << "the device gathers anyway";
    const Scene scene = court();
    BakeDesc desc = precise(Method::Hybrid, 64);
    const Baked host = bakeScene(scene, desc);
    desc.deviceGather = true;
    EXPECT_LT(relativeError(host.lighting, bakeScene(scene, desc).lighting), 2e-5);
}

TEST(SkyLinks, BatchesAndTheCacheChangeNoByte) {
    const Scene scene = court();
    BakeDesc desc = precise(Method::Hybrid, 96);
    desc.smooth = true;
    const Baked baked = bakeScene(scene, desc);
    desc.batchMs = 0.3;
    desc.cache.kind = CacheSettings::Kind::None;
    EXPECT_TRUE(sameBytes(bakeScene(scene, desc).lighting, baked.lighting));
}

// Layers see the sky through the links that all of them share: its layer sends no ray of its own, and a lamp
// beside it has its own light.
TEST(SkyLinks, BringLayersWhatTheyBringAPlainBake) {
    Scene scene = court();
    scene.sky.radiance = {1.0f, 2.0f, 3.0f};
    BakeDesc desc = precise(Method::Hybrid, 4096);
    for (const bool lamp : {false, true}) {
        if (lamp) scene.lights = {lightAt(LightType::Point, {6.0f, 2.0f, 2.0f}, 5.0f)};
        for (const bool onDevice : {false, true}) {
            desc.deviceGather = onDevice;
            desc.layers = false;
            const Baked plain = bakeScene(scene, desc);
            desc.layers = true;
            const Baked layers = bakeScene(scene, desc);
            EXPECT_LT(relativeError(layers.lighting, plain.lighting), 0.01) << lamp << onDevice;
            const TexelRect all{0, 0, kAtlasSize, kAtlasSize};
            EXPECT_NEAR(statistics(layers.lighting, all).mean / statistics(plain.lighting, all).mean, 1.0,
                        1e-3);
            if (!lamp) {
                EXPECT_EQ(layers.progress.rays, plain.progress.rays) << onDevice;
            }
        }
    }
}

TEST(SkyLinks, ASkyOfLayersThatIsDimmedAndTurnedUpAgainCostsNoRay) {
    BakeDesc desc = kQuick;
    desc.size = kAtlasSize;
    Layered bake(court(), desc);
    bake.finish();
    const Light4 before = bake.light();
    const uint64_t rays = bake.progress().rays;
    bake.scene.sky.radiance = glm::vec3(0.0f);
    bake.edit();
    bake.finish();
    for (const glm::vec4& light : bake.light())
        ASSERT_EQ(glm::vec3(light), glm::vec3(0.0f));
    bake.scene.sky.radiance = glm::vec3(2.0f * kRadiance);
    bake.edit();
    bake.finish();
    const Light4 after = bake.light();
    for (size_t i = 0; i < before.size(); ++i)
        ASSERT_EQ(glm::vec3(after[i]), 2.0f * glm::vec3(before[i]));
    EXPECT_EQ(bake.progress().rays, rays);
}

// The told error is what is left, in the deep room, too. The first sample pass has 16 directions of each of
// few patches, and goes over them again and again: what is wrong with that must not stay.
TEST(SkyLinks, TellTheLocalErrorThatIsThere) {
    const Scene scene = court();
    BakeDesc desc = precise(Method::Hybrid, 8192);
    desc.passes = 16; // sample passes that know nothing of each other
    const Baked truth = bakeScene(scene, desc);
    desc = precise(Method::Hybrid, 0);
    desc.localError = 0.05;
    const Baked baked = bakeScene(scene, desc);
    const ImagePair pair({baked.lighting, "map"}, {truth.lighting, "truth"});
    const LocalPercentiles truly = pair.percentiles(pair.localErrors());
    EXPECT_NEAR(baked.progress.localError95 / truly.p95, 1.0, 0.2);
    const TexelRect all{0, 0, kAtlasSize, kAtlasSize};
    EXPECT_NEAR(statistics(baked.lighting, all).mean / statistics(truth.lighting, all).mean, 1.0, 3e-3);
}

} // namespace relume
