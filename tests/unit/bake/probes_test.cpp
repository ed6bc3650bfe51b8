#include "assets/base/error.h"
#include "assets/base/watch.h"
#include "bake/probes/probe_grid.h"
#include "bake/probes/probe_lamps.h"
#include "bake/probes/probe_light.h"

#include <array>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace relume {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(ProbeHarmonics, AreOrthonormalOverProbeDirections) {
    constexpr uint32_t kSamples = 2048;
    std::array<std::array<double, 9>, 9> products{};
    for (uint32_t face = 0; face < kProbeFaces; ++face)
        for (uint32_t k = 0; k < kSamples; ++k) {
            const glm::vec3 d = probeDirection(3, face, k);
            const std::array<double, 9> y = harmonicsAt(d);
            for (size_t i = 0; i < 9; ++i)
                for (size_t j = 0; j < 9; ++j)
                    products[i][j] += y[i] * y[j] * probeSolidAngle(d, kSamples);
        }
    for (size_t i = 0; i < 9; ++i)
        for (size_t j = 0; j < 9; ++j)
            EXPECT_NEAR(products[i][j], i == j ? 1.0 : 0.0, 0.003) << i << ' ' << j;
}

// A directional light's irradiance by nine coefficients is E (1/4 + cos / 2 + 5/32 (3 cos^2 - 1)), the first
// terms of the clamped cosine's series.
TEST(ProbeHarmonics, DirectionalLightHasTheCosinesSeries) {
    const glm::dvec3 to = glm::normalize(glm::dvec3(1, 2, -3));
    Harmonics light{};
    addLight(light, to, glm::dvec3(10, 20, 30));
    for (const glm::dvec3 axis : {glm::dvec3(0, 0, 1), glm::dvec3(1, 1, 1), glm::dvec3(-2, 1, 0.5), to}) {
        const glm::dvec3 n = glm::normalize(axis);
        const double c = glm::dot(n, to);
        const double share = 0.25 + 0.5 * c + 5.0 / 32.0 * (3.0 * c * c - 1.0);
        EXPECT_NEAR(irradiance(light, n).x, 10 * share, 1e-9);
        EXPECT_NEAR(irradiance(light, n).z, 30 * share, 1e-9);
    }
}

TEST(ProbeHarmonics, EvenLightGivesPiTimesItsRadiance) {
    Harmonics light{};
    light[0] = glm::dvec3(2.0 * std::sqrt(4.0 * kPi));
    EXPECT_NEAR(irradiance(light, {0, 1, 0}).y, 2.0 * kPi, 1e-9);
}

TEST(ProbeGrids, StandInTheMiddleOfTheBox) {
    const ProbeGrid grid = planProbeGrid({0, 0, 0}, {2.5f, 2.5f, 0.4f}, 1.0f);
    EXPECT_EQ(grid.counts, glm::uvec3(2, 2, 1));
    EXPECT_NEAR(grid.first.x, 0.75f, 1e-6f);
    EXPECT_NEAR(grid.first.y, 0.75f, 1e-6f);
    EXPECT_NEAR(grid.first.z, 0.2f, 1e-6f);
    const std::vector<glm::vec3> points = probePoints(grid);
    ASSERT_EQ(points.size(), 4u);
    EXPECT_NEAR(points[1].x, 1.75f, 1e-6f);
    EXPECT_NEAR(points[1].y, 0.75f, 1e-6f);
}

TEST(ProbeGrids, RefuseTooManyAndNameASpacingThatFits) {
    try {
        planProbeGrid({0, 0, 0}, {10, 10, 10}, 1e-3f);
        FAIL();
    } catch (const UsageError& e) {
        const std::string text = e.what();
        EXPECT_NE(text.find("10000 x 10000 x 10000"), std::string::npos) << text;
        const size_t at = text.find("a spacing of ");
        ASSERT_NE(at, std::string::npos) << text;
        EXPECT_NO_THROW(planProbeGrid({0, 0, 0}, {10, 10, 10}, std::stof(text.substr(at + 13)))) << text;
    }
    EXPECT_THROW(planProbeGrid({1, 1, 1}, {1, 1, 1}, 1.0f), UsageError);
}

/// A probe that sees nothing but these links.
ProbeLinks uniformLinks(uint32_t link) {
    ProbeLinks links{.points = {glm::vec3(0.0f)}, .samples = 1024};
    links.links.assign(kProbeFaces * links.samples, link);
    return links;
}

// One patch is all that is seen, so all coefficients but the first vanish; a link to a back brings no light.
TEST(ProbeLight, LinksBringWhatPatchesSend) {
    WorkerPool pool(2);
    const std::array<ProbeLight, 2> lights = {ProbeLight{.radiance = {glm::vec4(2, 3, 4, 0)}},
                                              ProbeLight{.radiance = {glm::vec4(0, 6, 0, 0)}}};
    const ProbeLinks patch = uniformLinks(0);
    const auto lit = gatherProbes(pool, patch, lights);
    ASSERT_EQ(lit.size(), 2u);
    const double first = 3.0 * std::sqrt(4.0 * kPi);
    EXPECT_NEAR(lit[0].at(0)[0].y, first, 0.003 * first);
    EXPECT_NEAR(lit[1].at(0)[0].y, 2.0 * lit[0][0][0].y, 1e-9);
    EXPECT_EQ(lit[1].at(0)[0].x, 0.0);
    EXPECT_EQ(probeBacks(pool, patch).at(0), 0.0);
    const ProbeLinks back = uniformLinks(shader::kLinkBack);
    EXPECT_NEAR(probeBacks(pool, back).at(0), 1.0, 0.003);
    EXPECT_EQ(gatherProbes(pool, back, lights).at(0).at(0)[0].y, 0.0);
}

TEST(ProbeLight, TheSkyShinesWhereNothingIsMetForLightsThatHaveIt) {
    WorkerPool pool(1);
    Sky sky;
    sky.radiance = glm::vec3(7.0f); // a light's own weight counts
    const std::array<ProbeLight, 2> lights = {ProbeLight{.sky = &sky, .skyRadiance = {1, 2, 3}},
                                              ProbeLight{}};
    const auto lit = gatherProbes(pool, uniformLinks(shader::kLinkSky), lights);
    EXPECT_NEAR(lit[0].at(0)[0].z, 3.0 * std::sqrt(4.0 * kPi), 0.03);
    EXPECT_EQ(lit[1].at(0)[0].z, 0.0);
}

// Floats are 0.06 m apart a million metres from the origin, but a sun's light comes from where it did.
TEST(ProbeLight, ASunShinesFromItsDirectionFarFromTheOrigin) {
    WorkerPool pool(1);
    shader::Lamp sun{};
    sun.type = shader::kLampSun;
    sun.axis = glm::normalize(glm::vec3(-0.3f, -0.8f, 0.5f));
    sun.radius = 0.1f;
    sun.samples = kProbeLampSamples;
    const auto lit = [&](const glm::vec3& point) {
        ProbeLinks links{.points = {point}, .lamps = {sun}, .targets = kProbeLampSamples};
        links.seen.assign(kProbeLampSamples, 1);
        const std::array<ProbeLight, 1> light = {ProbeLight{.lamps = {glm::vec3(5.0f)}}};
        return gatherProbes(pool, links, light).at(0).at(0);
    };
    const Harmonics near = lit(glm::vec3(0.0f)), far = lit({1e6f, 1e6f, -1e6f});
    for (size_t i = 0; i < near.size(); ++i)
        EXPECT_NEAR(far[i].x, near[i].x, 1e-6) << i;
    const std::array<double, 9> values = harmonicsAt(-sun.axis);
    EXPECT_NEAR(near[0].x, 5.0 * values[0], 0.01); // it brings its lux, from around its middle
    EXPECT_NEAR(near[1].x, 5.0 * values[1], 0.05);
    // A ray starts where the probe stands, and leads that way as far as it is asked to.
    const ProbeLampRay ray = sampleProbeLamp(sun, {2.0f, 3.0f, 4.0f}, 0, 5, 100.0f);
    const glm::vec3 end = glm::vec3(2.0f, 3.0f, 4.0f) + 100.0f * ray.direction;
    for (glm::length_t c = 0; c < 3; ++c)
        EXPECT_NEAR(ray.target[c], end[c], 1e-4f);
}

TEST(ProbeLight, IsTheSameOnAnyNumberOfThreads) {
    ProbeLinks links{.points = std::vector<glm::vec3>(40, glm::vec3(0.0f)), .samples = 16};
    links.first = 64;
    for (size_t i = 0; i < links.points.size() * kProbeFaces * links.samples; ++i)
        links.links.push_back(i % 7 == 0 ? shader::kLinkBack : static_cast<uint32_t>(i % 3));
    const std::array<ProbeLight, 1> light = {
        ProbeLight{.radiance = {glm::vec4(2, 3, 4, 0), glm::vec4(0.1f), glm::vec4(7, 0, 1, 0)}}};
    WorkerPool one(1), three(3);
    EXPECT_EQ(gatherProbes(one, links, light), gatherProbes(three, links, light));
    EXPECT_EQ(probeBacks(one, links), probeBacks(three, links));
}

// A mesh light is seen by what its patches send for its weight; others of the same material stay dark.
TEST(ProbeLight, MeshLightsAreSeenWithTheirOwnWeight) {
    Scene scene;
    scene.lights.resize(2);
    PatchSet patches;
    patches.albedo.assign(3, glm::vec4(0.5f));
    patches.emissionPattern = {glm::vec4(1.0f), glm::vec4(0.5f), glm::vec4(1.0f)};
    patches.instance = {0, 0, 1};
    patches.material = {4, 4, 4};
    const std::vector<glm::vec4> lighting(3, glm::vec4(2.0f));
    const std::array<LightSource, 2> sources = {
        LightSource{{LightKey::Kind::Emitter, 0, 4}, "plate", glm::vec3(10.0f)},
        LightSource{{LightKey::Kind::Lamp, 1, 0}, "bulb", glm::vec3(3.0f)}};
    const ProbeLight light = probeLight(scene, patches, sources, lighting, 0.8f);
    ASSERT_EQ(light.radiance.size(), 3u);
    EXPECT_FLOAT_EQ(light.radiance[0].x, 10.8f);
    EXPECT_FLOAT_EQ(light.radiance[1].x, 5.8f);
    EXPECT_FLOAT_EQ(light.radiance[2].x, 0.8f);
    EXPECT_EQ(light.lamps, (std::vector<glm::vec3>{glm::vec3(0.0f), glm::vec3(3.0f)}));
    EXPECT_EQ(light.sky, nullptr);
}

/// Ends a job when it is told of it for the second time.
class Stop final : public Watch {
public:
    void hear(const char*, double) override {
        if (++heard == 2) throw Error("stopped");
    }
    int heard = 0;
};

TEST(ProbeLight, AWatchEndsTheGather) {
    WorkerPool pool(1);
    ProbeLinks links{.points = std::vector<glm::vec3>(40, glm::vec3(0.0f)), .samples = 8};
    links.links.assign(40 * kProbeFaces * links.samples, 0);
    const std::array<ProbeLight, 1> light = {ProbeLight{.radiance = {glm::vec4(1.0f)}}};
    Stop stop;
    const WatchScope scope(stop);
    EXPECT_THROW((void)gatherProbes(pool, links, light), Error);
}

TEST(ProbeMemory, IsBoundedForAnyNumberOfProbes) {
    constexpr uint64_t kPatches = 1000, kMega = 1u << 20;
    EXPECT_EQ(probeTracerBytes({.count = 0}, kPatches), 0u);
    const uint64_t few = probeTracerBytes({.count = 1}, kPatches);
    const uint64_t many =
        probeTracerBytes({.count = kMostProbes, .samples = 16384, .targets = 640}, kPatches);
    EXPECT_LT(few, many);
    EXPECT_LT(many, 64 * kMega);
    for (const uint32_t samples : {8u, 4096u, 16384u}) {
        EXPECT_EQ(probeBatch(samples) % kProbeStride, 0u);
        EXPECT_LE(uint64_t{probeBatch(samples)} * kProbeFaces * samples * sizeof(uint32_t), 13 * kMega);
    }
    EXPECT_EQ(probeLightsAtOnce(uint64_t{1} << 40), 1u);
    EXPECT_GT(probeLightsAtOnce(0), 1u);
}

} // namespace
} // namespace relume
