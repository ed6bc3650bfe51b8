// Light probes of a bake with layers: light by light, against bakes of these lights alone; and what they
// take.
#include "app/offline/probe_bake.h"
#include "assets/base/error.h"
#include "assets/base/watch.h"
#include "tests/gpu/gpu_environment.h"
#include "tests/gpu/layered.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

namespace relume {
namespace {

constexpr uint32_t kSides = 1024;
// Both bakes have so much noise at most, which hardly any is left of in a probe's light.
constexpr double kNoise = 0.02;

ProbePlan places() {
    ProbePlan plan;
    plan.points = {{0.3f, 0.4f, 0.5f}, {1.0f, 1.0f, 1.0f}, {1.7f, 1.5f, 0.3f}, {0.8f, 0.2f, 1.5f}};
    return plan;
}

ProbeSet probesOf(const Scene& scene, Baker& baker) {
    return bakeProbes(testDevice(), scene, baker, places(), kSides, 1.0f);
}

BakeDesc described(bool layers) {
    return {.passes = 0, .method = Method::Hybrid, .samples = 256, .smooth = true, .layers = layers};
}

ProbeSet bakedProbes(const Scene& scene, bool layers) {
    const auto baker = makeBaker(scene, described(layers));
    while (!baker->solver().done())
        baker->solver().step();
    return probesOf(scene, *baker);
}

/// Expects the irradiance of both to be the same in six directions, up to noise of the mean.
void expectSameLight(const std::vector<Probe>& a, const std::vector<Probe>& b, const std::string& what) {
    ASSERT_EQ(a.size(), b.size());
    for (size_t p = 0; p < a.size(); ++p)
        for (int axis = 0; axis < 3; ++axis)
            for (const double sign : {-1.0, 1.0}) {
                glm::dvec3 normal(0.0);
                normal[axis] = sign;
                const glm::dvec3 x = irradiance(a[p].radiance, normal), y = irradiance(b[p].radiance, normal);
                const double mean = b[p].radiance[0].g * 0.886; // irradiance of even light: sqrt(pi) / 2
                EXPECT_NEAR(x.g, y.g, kNoise * mean) << what << ", probe " << p << ", axis " << axis;
            }
}

/// Returns the scene with only the analytic light of this name, and no mesh light.
Scene aloneIn(Scene scene, const std::string& name) {
    std::erase_if(scene.lights, [&](const Light& light) { return light.name != name; });
    for (Material& material : scene.materials)
        material.emission = glm::vec3(0.0f);
    return scene;
}

} // namespace

TEST(ProbeLayers, SumUpToThePlainBakesLight) {
    const Scene scene = room();
    const ProbeSet layered = bakedProbes(scene, true), plain = bakedProbes(scene, false);
    ASSERT_EQ(layered.layers.size(), 4u);
    EXPECT_TRUE(plain.layers.empty());
    EXPECT_EQ(layered.layers[1].light.name, "Bulb");
    EXPECT_EQ(layered.layers[1].light.attributes.at(layer_attribute::kUnit), "cd");
    expectSameLight(layered.probes, plain.probes, "sum");
    EXPECT_EQ(layered.probes[0].backs, plain.probes[0].backs);
}

TEST(ProbeLayers, EachIsItsLightAlone) {
    Scene scene = room();
    ProbeSet layered = bakedProbes(scene, true);
    for (const std::string name : {"Bulb", "Spot", "Panel"}) {
        for (ProbeSet::Layer& layer : layered.layers) {
            const bool isIt = layer.light.name == name;
            layer.light.weight = glm::vec3(0.0f);
            if (!isIt) continue;
            const auto light = std::find_if(scene.lights.begin(), scene.lights.end(),
                                            [&](const Light& one) { return one.name == name; });
            layer.light.weight = light->color * light->intensity;
        }
        sumLayers(layered);
        expectSameLight(layered.probes, bakedProbes(aloneIn(scene, name), false).probes, name);
    }
}

// A sky, and lights that share a layer.
TEST(ProbeLayers, GroupsAndTheSkyAreAmongThem) {
    Scene scene = room();
    scene.instances.erase(scene.instances.begin() + 5); // a wall
    scene.sky.radiance = {2.0f, 3.0f, 4.0f};
    BakeDesc desc = described(true);
    const auto counted = makeBaker(scene, desc);
    desc.layerBytes = uint64_t{counted->patches().scene.patches.size()} * 2 * sizeof(glm::vec4) * 4;
    const auto baker = makeBaker(scene, desc);
    while (!baker->solver().done())
        baker->solver().step();
    const ProbeSet grouped = probesOf(scene, *baker), plain = bakedProbes(scene, false);
    const auto isGroup = [](const ProbeSet::Layer& layer) {
        return layer.light.attributes.contains(layer_attribute::kMembers);
    };
    EXPECT_TRUE(std::any_of(grouped.layers.begin(), grouped.layers.end(), isGroup));
    EXPECT_TRUE(std::any_of(grouped.layers.begin(), grouped.layers.end(),
                            [](const ProbeSet::Layer& layer) { return layer.light.name == "Sky"; }));
    expectSameLight(grouped.probes, plain.probes, "sum with a group");
}

TEST(ProbeLayers, AWatchEndsThem) {
    class Stop final : public Watch {
    public:
        void hear(const char* phase, double) override {
            if (std::string(phase) == "light probes") throw Error("stopped");
        }
    } stop;
    const Scene scene = room();
    const auto baker = makeBaker(scene, described(false));
    while (!baker->solver().done())
        baker->solver().step();
    const uint64_t before = testDevice().ledger().bytes();
    {
        const WatchScope scope(stop);
        EXPECT_THROW((void)probesOf(scene, *baker), Error);
    }
    EXPECT_EQ(testDevice().ledger().bytes(), before) << "all is given back";
}

// A single probe and some batches of them.
TEST(ProbeLayers, TakeNoMoreMemoryThanIsPlanned) {
    const Scene scene = room();
    const auto baker = makeBaker(scene, described(false));
    while (!baker->solver().done())
        baker->solver().step();
    vk::MemoryLedger& ledger = testDevice().ledger();
    const PatchSet& patches = baker->patches();
    for (const size_t count : {size_t{1}, size_t{700}}) {
        ProbePlan plan;
        plan.points.assign(count, glm::vec3(1.0f));
        ProbeOptions options;
        options.samples = kSides;
        BakeSettings settings;
        settings.size = 64;
        settings.probes = probeExtent(options, plan, scene, false);
        EXPECT_EQ(settings.probes.targets, 2 * kProbeLampSamples + 1);
        const SolverExtent extent{.chunkCount = patches.chunkCount(),
                                  .texels = 64 * 64,
                                  .software = testDevice().info().software()};
        const uint64_t planned = memoryNeeds(settings, extentOf(scene, patches.scene.mesh), extent).probes;
        const uint64_t before = ledger.bytes();
        ledger.resetPeak();
        (void)bakeProbes(testDevice(), scene, *baker, plan, kSides, 1.0f);
        EXPECT_LE(ledger.peak() - before, planned) << count;
        EXPECT_GT(ledger.peak() - before, planned / 4) << count;
    }
}

} // namespace relume
