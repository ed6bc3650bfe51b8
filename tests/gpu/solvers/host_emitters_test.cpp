// Direct light of mesh lights that the CPU samples and gathers is that of the device's kernels.
#include "tests/gpu/bake_scene.h"
#include "tests/gpu/gpu_environment.h"

#include <gtest/gtest.h>

namespace relume {
namespace {

// What shines.
enum class Shape { Parallelogram, Triangle, Quad };

// How far from the floor it does: texels are nearer than four of their sizes, or many of the light's sizes
// away.
enum class Place { Near, Far };

// A room with one light in it, which stands askew so that no two of its corners are as far from a texel. It
// is so dark that light which comes by links, which the device packs and the CPU does not, hardly counts.
Scene room(Shape shape, Place place, bool shadows) {
    SceneMaker maker(64);
    const int dark = maker.material(0.001f), bright = maker.material(0.001f, 5.0f);
    maker.box(glm::vec3(0.0f), {4.0f * kX, 4.0f * kY, 4.0f * kZ}, dark, 16);
    const float height = place == Place::Near ? 0.02f : 3.7f, size = place == Place::Near ? 1.5f : 0.4f;
    const glm::vec3 u(size, 0.0f, 0.1f), v(0.3f * size, -0.9f * size, 0.02f);
    maker.quad({1.3f, 2.6f, height}, u, v, bright, {8, 8}); // shines down
    const size_t mesh = maker.scene().meshes.size() - 1;
    if (shadows) maker.blocker({1.0f, 1.0f, 0.5f * height}, 0.8f * kX, 0.7f * kY, dark);
    Scene scene = maker.scene();
    Primitive& light = scene.meshes[mesh].primitives[0];
    if (shape == Shape::Triangle) light.indices.resize(3);
    if (shape == Shape::Quad) light.positions.back() -= 0.3f * u + 0.1f * v;
    return scene;
}

// Without shadows all points are seen, so that rounding is all that differs. Where a shadow falls, rounding
// may move the end of a ray across its edge: one of the points of a texel, of which some hundred lie where
// shadows end.
constexpr double kRounding = 2e-6, kAtEdges = 1e-3;

struct Case {
    Shape shape;
    Place place;
    bool allOver, layers;
};

class HostEmittersBake : public testing::TestWithParam<Case> {};

void expectAlike(const Case& c, bool shadows, double tolerance) {
    if (!testDevice().info().software()) GTEST_SKIP() << "the device samples and gathers anyway";
    const Scene scene = room(c.shape, c.place, shadows);
    BakeDesc desc{
        .passes = 0, .allOver = c.allOver, .method = Method::Hybrid, .samples = 32, .layers = c.layers};
    const Baked host = bakeScene(scene, desc);
    desc.deviceGather = true;
    const Baked device = bakeScene(scene, desc);
    EXPECT_LT(relativeError(host.lighting, device.lighting), tolerance);
    EXPECT_EQ(host.progress.rays, device.progress.rays);
    EXPECT_NEAR(host.progress.error / device.progress.error, 1.0, 1e-3);
}

TEST_P(HostEmittersBake, MakeWhatTheDeviceDoes) {
    expectAlike(GetParam(), false, kRounding);
}

TEST_P(HostEmittersBake, MakeWhatTheDeviceDoesOfShadows) {
    expectAlike(GetParam(), true, kAtEdges);
}

std::vector<Case> cases() {
    std::vector<Case> all;
    for (const Shape shape : {Shape::Parallelogram, Shape::Triangle, Shape::Quad})
        for (const Place place : {Place::Near, Place::Far})
            for (const bool allOver : {false, true})
                for (const bool layers : {false, true})
                    all.push_back({shape, place, allOver, layers});
    return all;
}

std::string nameOf(const testing::TestParamInfo<Case>& info) {
    const Case& c = info.param;
    const std::string shape = c.shape == Shape::Parallelogram ? "Parallelogram"
                              : c.shape == Shape::Triangle    ? "Triangle"
                                                              : "Quad";
    return shape + (c.place == Place::Near ? "Near" : "Far") + (c.allOver ? "AllOver" : "AtPoints") +
           (c.layers ? "Layers" : "");
}

INSTANTIATE_TEST_SUITE_P(All, HostEmittersBake, testing::ValuesIn(cases()), nameOf);

} // namespace
} // namespace relume
