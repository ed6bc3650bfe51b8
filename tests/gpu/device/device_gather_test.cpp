// A software device gathers on the host; its shaders, which other devices run, must come to the same.
#include "assets/generate/generate.h"
#include "tests/gpu/bake_scene.h"
#include "tests/gpu/gpu_environment.h"

#include <gtest/gtest.h>

namespace relume {
namespace {

struct DeviceGatherCase {
    const char* name;
    BakeDesc desc;
    double error; // relRMSE: rounding, of links also that of light in 8 bytes
};
void PrintTo(const DeviceGatherCase& c, std::ostream* out) {
    *out << c.name;
}

class DeviceGather : public testing::TestWithParam<DeviceGatherCase> {};

INSTANTIATE_TEST_SUITE_P(
    All, DeviceGather,
    testing::Values(
        DeviceGatherCase{"pure", {.passes = 2}, 1e-6},
        DeviceGatherCase{
            "montecarlo", {.passes = 2, .method = Method::MonteCarlo, .pairs = {.window = 4}}, 1e-6},
        DeviceGatherCase{
            "mipmapped", {.passes = 2, .method = Method::Mipmapped, .pairs = {.window = 2}}, 1e-6},
        DeviceGatherCase{
            "layers", {.passes = 3, .method = Method::Hybrid, .samples = 32, .layers = true}, 2e-5},
        DeviceGatherCase{"hybrid", {.passes = 3, .method = Method::Hybrid, .samples = 32}, 2e-5},
        DeviceGatherCase{"directional",
                         {.passes = 3, .method = Method::Directional, .samples = 32, .indirectScale = 2},
                         2e-5}),
    [](const auto& test) { return std::string(test.param.name); });

} // namespace

TEST_P(DeviceGather, ComesToWhatTheHostGathers) {
    if (!testDevice().info().software()) GTEST_SKIP() << "the device gathers anyway";
    const Scene scene = generateScene("cornell_geom");
    BakeDesc desc = GetParam().desc;
    desc.size = 64;
    const Baked host = bakeScene(scene, desc);
    desc.deviceGather = true;
    const Baked device = bakeScene(scene, desc);
    EXPECT_EQ(host.progress.rays, device.progress.rays);
    EXPECT_LT(relativeError(host.lighting, device.lighting), GetParam().error);
}

// The device counts the texels where the local error of all layers together decides.
TEST(DeviceGather, TellsTheLocalErrorOfLayersThatTheHostTells) {
    if (!testDevice().info().software()) GTEST_SKIP() << "the device gathers anyway";
    const Scene scene = generateScene("cornell_layers");
    for (const double localError : {0.5, 0.08}) {
        BakeDesc desc{.passes = 0,
                      .error = 0.1,
                      .localError = localError,
                      .method = Method::Hybrid,
                      .smooth = true,
                      .layers = true};
        const SolverProgress host = bakeScene(scene, desc).progress;
        desc.deviceGather = true;
        const SolverProgress device = bakeScene(scene, desc).progress;
        EXPECT_LT(host.localError95, localError);
        EXPECT_GT(host.localError95, 0.1 * localError);
        EXPECT_NEAR(device.localError95, host.localError95, 0.01 * host.localError95);
        EXPECT_NEAR(device.localError99, host.localError99, 0.01 * host.localError99);
        EXPECT_EQ(device.rays, host.rays);
    }
}

} // namespace relume
