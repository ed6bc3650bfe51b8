#include "app/edit/prepare.h"
#include "assets/images/float_image.h"
#include "assets/images/image_file.h"
#include "assets/images/metrics.h"
#include "bake/baker/baker.h"
#include "bake/trace/make_tracer.h"
#include "bake/trace/voxel_map.h"
#include "tests/gpu/gpu_environment.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <gtest/gtest.h>

// Bakes are held against RTRad's own pictures. It showed the lightmap stretched over 1440 x 810 pixels,
// bilinear with 8-bit weights, wrapped at the borders, clamped and sRGB encoded to 8 bits; DFPR is the mean
// RGB distance in units of full scale.

namespace relume {
namespace {

const std::string kScene = RELUME_SHARED_DIR "/scenes/rtrad/CornellLucy.glb";
const std::string kPictures = RELUME_SHARED_DIR "/references/rtrad/";

FloatImage bakePreset(uint32_t size, TracerKind tracer, const VoxelSettings& voxels = {},
                      Method method = Method::Pure, uint32_t window = 1) {
    PreparedScene prepared = prepareScene({.path = kScene, .size = size});
    BakeSettings settings;
    settings.size = size;
    settings.tracer = tracer;
    settings.voxels = voxels;
    settings.solver.transport = {.reflectivity = 0.9f, .rtrad = true};
    settings.solver.method = method;
    settings.solver.pairs.window = window;
    settings.solver.passes = 2;
    settings.solver.error = 0;
    Baker baker(testDevice(), prepared.scene, std::move(prepared.mesh), settings);
    while (!baker.solver().done())
        baker.solver().step();
    return baker.lightmap({.quantity = Quantity::Radiance});
}

struct Taps {
    uint32_t i0, i1;
    double f;
};
Taps tapsAt(uint32_t pixel, uint32_t pixels, uint32_t texels) {
    const double t = (pixel + 0.5) / pixels * texels - 0.5, base = std::floor(t);
    const auto wrapped = [&](double i) {
        return static_cast<uint32_t>((static_cast<int64_t>(i) + texels) % texels);
    };
    return {wrapped(base), wrapped(base + 1), std::round((t - base) * 256) / 256};
}

double encoded(double linear) {
    const double x = std::clamp(linear, 0.0, 1.0);
    return std::round(255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055));
}

double dfprAgainst(const FloatImage& lightmap, const std::string& picture) {
    const FloatImage shown = readImage(picture);
    double sum = 0;
    for (uint32_t y = 0; y < shown.height; ++y) {
        const Taps v = tapsAt(y, shown.height, lightmap.height);
        for (uint32_t x = 0; x < shown.width; ++x) {
            const Taps u = tapsAt(x, shown.width, lightmap.width);
            double squares = 0;
            for (const char* channel : {"R", "G", "B"}) {
                const auto& plane = *lightmap.find(channel);
                const auto at = [&](uint32_t i, uint32_t j) {
                    return double{plane[size_t{j} * lightmap.width + i]};
                };
                const double top = at(u.i0, v.i0) * (1 - u.f) + at(u.i1, v.i0) * u.f;
                const double bottom = at(u.i0, v.i1) * (1 - u.f) + at(u.i1, v.i1) * u.f;
                const double theirs = encoded((*shown.find(channel))[size_t{y} * shown.width + x]);
                const double difference = encoded(top * (1 - v.f) + bottom * v.f) - theirs;
                squares += difference * difference;
            }
            sum += std::sqrt(squares);
        }
    }
    return sum / 255 / (static_cast<double>(shown.width) * shown.height);
}

TEST(Reference, purePresetMatchesRtradsPicture) {
    if (!std::filesystem::exists(kScene)) GTEST_SKIP() << kScene << " is not there";
    std::string why;
    const TracerKind tracer = chooseTracer(testDevice().info(), why);
    EXPECT_LE(dfprAgainst(bakePreset(128, tracer), kPictures + "128_1x1.png"), 0.001);
}

TEST(Reference, voxelMarchingMatchesRtradsPicture) {
    if (!std::filesystem::exists(kScene)) GTEST_SKIP() << kScene << " is not there";
    const FloatImage image = bakePreset(256, TracerKind::Voxel, {.resolution = 32});
    EXPECT_LE(dfprAgainst(image, kPictures + "256_VXRM_32.png"), 0.001);
}

// One sender in four is marched to, whatever tracer serves the others; the light lies between both.
TEST(Reference, voxelRatioMixesMarchesAndRays) {
    if (!std::filesystem::exists(kScene)) GTEST_SKIP() << kScene << " is not there";
    constexpr uint32_t kSize = 48;
    const VoxelSettings mixture{.resolution = 32, .ratio = 4};
    const FloatImage rays = bakePreset(kSize, TracerKind::Bvh);
    const FloatImage mixed = bakePreset(kSize, TracerKind::Bvh, mixture);
    const FloatImage voxels = bakePreset(kSize, TracerKind::Voxel, {.resolution = 32});
    const auto distance = [](const FloatImage& a, const FloatImage& b) {
        return compareImages(a, "a", b, "b").dfpr;
    };
    EXPECT_GT(distance(mixed, rays), 0.001);
    EXPECT_LT(distance(mixed, rays), distance(mixed, voxels));
    EXPECT_LT(distance(mixed, voxels), distance(rays, voxels));
    if (!tracerProblem(TracerKind::Embree, testDevice().info()).empty()) return;
    EXPECT_LE(distance(mixed, bakePreset(kSize, TracerKind::Embree, mixture)), 0.0002);
}

// The bake of the adaptive picture is too long for a test; run it by hand:
//   relume bake CornellLucy.glb --preset rtrad --method adaptive --passes 2 --size 512 -o MAP.exr
//   relume compare MAP.exr 512_T05.png --metric dfpr
TEST(Reference, monteCarloPresetMatchesRtradsPictures) {
    if (!std::filesystem::exists(kScene)) GTEST_SKIP() << kScene << " is not there";
    std::string why;
    const TracerKind tracer = chooseTracer(testDevice().info(), why);
    EXPECT_LE(dfprAgainst(bakePreset(128, tracer, {}, Method::MonteCarlo, 2), kPictures + "128_2x2.png"),
              0.001);
    EXPECT_LE(dfprAgainst(bakePreset(256, tracer, {}, Method::MonteCarlo, 4), kPictures + "256_4x4.png"),
              0.001);
}

// Every other tracer gives the same map, so it matches the picture too.
TEST(Reference, presetIsTheSameWithEveryTracer) {
    if (!std::filesystem::exists(kScene)) GTEST_SKIP() << kScene << " is not there";
    constexpr uint32_t kSize = 48;
    std::string why;
    const FloatImage expected = bakePreset(kSize, chooseTracer(testDevice().info(), why));
    for (TracerKind tracer : {TracerKind::Rtp, TracerKind::Query, TracerKind::Bvh}) {
        if (!tracerProblem(tracer, testDevice().info()).empty()) continue;
        const FloatImage image = bakePreset(kSize, tracer);
        EXPECT_LE(compareImages(image, tracerName(tracer), expected, "expected").dfpr, 0.0002)
            << tracerName(tracer);
    }
}

} // namespace
} // namespace relume
