// Light probes as engines read them.
#include "app/offline/probe_files.h"
#include "app/offline/probe_forms.h"
#include "assets/base/error.h"
#include "assets/images/ktx2.h"
#include "tests/temporary_folder.h"
#include "tests/text.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace relume {
namespace {

/// A grid of probes in even light, each as bright as its number says, from 1 on.
ProbeSet evenGrid(const glm::uvec3& counts) {
    ProbeSet set;
    set.grid = ProbeGrid{{0.5f, 1.0f, 1.5f}, 0.5f, counts};
    for (const glm::vec3& point : probePoints(*set.grid)) {
        Probe probe{.position = point};
        const auto number = static_cast<double>(set.probes.size() + 1);
        probe.radiance[0] = glm::dvec3(1, 2, 3) * number * std::sqrt(4.0 * std::numbers::pi);
        set.probes.push_back(probe);
    }
    return set;
}

float texelOf(const FloatImage& volume, const glm::uvec3& counts, const glm::uvec3& at, int channel) {
    const size_t row = size_t{at.z} * 2 * counts.y + at.y;
    return volume.planes[static_cast<size_t>(channel)][row * counts.x + at.x];
}

TEST(ProbeForms, AmbientCubesLieAsBevysShaderReadsThem) {
    constexpr glm::uvec3 kCounts(3, 2, 2);
    ProbeSet set = evenGrid(kCounts);
    // Light from +X and a bit from -Z comes to the probe (2, 1, 0).
    const size_t number = 1 * 3 + 2;
    set.probes[number].radiance = {};
    addLight(set.probes[number].radiance, {1, 0, 0}, glm::dvec3(8));
    addLight(set.probes[number].radiance, {0, 0, -1}, glm::dvec3(4));
    const FloatImage volume = ambientCubes(*set.grid, set.probes);
    ASSERT_EQ(volume.width, 3u);
    ASSERT_EQ(volume.height, 4u * 6u);
    const auto side = [&](const glm::dvec3& normal) {
        return std::max(irradiance(set.probes[number].radiance, normal).g, 0.0) / std::numbers::pi;
    };
    EXPECT_GT(side({1, 0, 0}), side({0, 0, -1}));
    EXPECT_NEAR(texelOf(volume, kCounts, {2, 1, 0}, 1), side({1, 0, 0}), 1e-5);
    EXPECT_NEAR(texelOf(volume, kCounts, {2, 2 + 1, 0}, 1), side({-1, 0, 0}), 1e-5);
    EXPECT_NEAR(texelOf(volume, kCounts, {2, 1, 2}, 1), side({0, 1, 0}), 1e-5);
    EXPECT_NEAR(texelOf(volume, kCounts, {2, 2 + 1, 2}, 1), side({0, -1, 0}), 1e-5);
    EXPECT_NEAR(texelOf(volume, kCounts, {2, 1, 4}, 1), side({0, 0, 1}), 1e-5);
    EXPECT_NEAR(texelOf(volume, kCounts, {2, 2 + 1, 4}, 1), side({0, 0, -1}), 1e-5);
    // All sides of a probe in even light are its radiance: number 7 stands at (0, 0, 1).
    for (const uint32_t slice : {1u, 3u, 5u})
        for (const uint32_t half : {0u, 2u})
            EXPECT_NEAR(texelOf(volume, kCounts, {0, half, slice}, 2), 7 * 3, 1e-4);
    for (const float value : volume.planes[0])
        EXPECT_GE(value, 0.0f);
}

TEST(ProbeForms, ProbesInsideWallsTakeTheirNeighboursLight) {
    ProbeSet set = evenGrid({4, 1, 1});
    set.probes[1].backs = set.probes[2].backs = set.probes[3].backs = 1.0;
    std::vector<Harmonics> radiance = freeRadiance(*set.grid, set.probes);
    for (const Harmonics& one : radiance)
        EXPECT_EQ(one, set.probes[0].radiance); // it spreads, layer by layer
    set.probes[3].backs = 0.0;
    radiance = freeRadiance(*set.grid, set.probes);
    EXPECT_EQ(radiance[1], set.probes[0].radiance);
    EXPECT_EQ(radiance[2], set.probes[3].radiance);
    EXPECT_EQ(radiance[3], set.probes[3].radiance);
    for (Probe& probe : set.probes)
        probe.backs = 1.0;
    radiance = freeRadiance(*set.grid, set.probes);
    EXPECT_EQ(radiance[2], set.probes[2].radiance); // nobody stands free
}

TEST(ProbeForms, AVolumeHasAnEdgeThatDevicesHold) {
    EXPECT_EQ(volumeProblem({.counts = {2048, 1, 1}}), "");
    EXPECT_EQ(volumeProblem({.counts = {1, 1024, 1}}), "");
    EXPECT_EQ(volumeProblem({.counts = {1, 1, 682}}), "");
    EXPECT_TRUE(contains(volumeProblem({.counts = {2049, 1, 1}}), "2049 x 2 x 3"));
    EXPECT_NE(volumeProblem({.counts = {1, 1025, 1}}), "");
    EXPECT_NE(volumeProblem({.counts = {1, 1, 683}}), "");
}

// three.js' own formula of the irradiance, with its constants [SphericalHarmonics3.getIrradianceAt].
double threesIrradiance(const std::vector<double>& sh, size_t channel, const glm::dvec3& n) {
    const auto c = [&](size_t i) { return sh[3 * i + channel]; };
    return 0.886227 * c(0) + 2 * 0.511664 * (n.y * c(1) + n.z * c(2) + n.x * c(3)) +
           2 * 0.429043 * (n.x * n.y * c(4) + n.y * n.z * c(5) + n.x * n.z * c(7)) +
           (0.743125 * n.z * n.z - 0.247708) * c(6) + 0.429043 * (n.x * n.x - n.y * n.y) * c(8);
}

TEST(ProbeForms, ThreesProbesShineAsOurs) {
    ProbeSet set = evenGrid({2, 1, 1});
    addLight(set.probes[1].radiance, glm::normalize(glm::dvec3(1, 2, -3)), {5, 6, 7});
    set.probes[1].backs = 0.75;
    const nlohmann::json made = nlohmann::json::parse(threeProbes(set, "p.three.json"));
    EXPECT_EQ(made["object"]["type"], "Group");
    EXPECT_EQ(made["object"]["userData"]["grid"]["counts"], (std::vector<int>{2, 1, 1}));
    const nlohmann::json& probe = made["object"]["children"].at(1);
    EXPECT_EQ(probe["type"], "LightProbe");
    EXPECT_EQ(probe["userData"]["inside"], true);
    EXPECT_FLOAT_EQ(probe["matrix"].at(12).get<float>(), 1.0f);
    EXPECT_FLOAT_EQ(probe["matrix"].at(14).get<float>(), 1.5f);
    EXPECT_NE(probe["uuid"], made["object"]["children"].at(0)["uuid"]);
    const auto sh = probe["sh"].get<std::vector<double>>();
    ASSERT_EQ(sh.size(), 27u);
    for (const glm::dvec3 axis : {glm::dvec3(1, 0, 0), {0, -1, 0}, {1, 2, 3}, {-3, 1, -2}, {0, 0, 1}}) {
        const glm::dvec3 n = glm::normalize(axis), ours = irradiance(set.probes[1].radiance, n);
        EXPECT_NEAR(threesIrradiance(sh, 0, n), ours.r, 1e-5 * ours.r);
        EXPECT_NEAR(threesIrradiance(sh, 2, n), ours.b, 1e-5 * ours.b);
    }
}

TEST(ProbeFiles, AreOfTheFormThatTheirNameAsksFor) {
    EXPECT_EQ(probeFormOf("--probes-out", "a.json"), ProbeForm::Relume);
    EXPECT_EQ(probeFormOf("--probes-out", "a.three.json"), ProbeForm::Three);
    EXPECT_EQ(probeFormOf("--probes-out", "a.ktx2"), ProbeForm::Bevy);
    EXPECT_THROW((void)probeFormOf("--probes-out", "a.exr"), UsageError);
    const TemporaryFolder folder;
    ProbeSet set = evenGrid({3, 2, 2});
    for (const char* name : {"a.json", "a.three.json", "a.ktx2"})
        writeProbes(folder.path(name), set);
    EXPECT_EQ(readProbes(folder.path("a.json")).probes.size(), 12u);
    EXPECT_TRUE(contains(bytesOf(folder.path("a.three.json")), "LightProbe"));
    EXPECT_TRUE(contains(bytesOf(folder.path("a.ktx2")), "KTX 20"));
    EXPECT_THROW((void)readProbes(folder.path("a.three.json")), Error);
    EXPECT_THROW((void)readProbes(folder.path("a.ktx2")), Error);
    // Without a grid there is no volume, and nothing is written.
    set.grid.reset();
    EXPECT_THROW(writeProbes(folder.path("b.ktx2"), set), Error);
    set.probes[0].radiance[0].r = std::nan("");
    EXPECT_THROW(writeProbes(folder.path("b.three.json"), set), Error);
    EXPECT_EQ(folder.files(), (std::vector<std::string>{"a.json", "a.ktx2", "a.three.json"}));
}

} // namespace
} // namespace relume
