#include "assets/base/error.h"
#include "bake/probes/probe_grid.h"
#include "bake/probes/probe_links.h"

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

// One patch is all that is seen, so all coefficients but the first vanish; a link to a back brings no light.
TEST(ProbeLight, LinksBringWhatPatchesSend) {
    ProbeLinks links{.points = {glm::vec3(0.0f)}, .samples = 1024};
    links.links.assign(kProbeFaces * links.samples, 0);
    const std::vector<glm::vec4> radiance = {glm::vec4(2, 3, 4, 0)};
    const Probe lit = gatherProbes(links, {.radiance = radiance}).at(0);
    EXPECT_NEAR(lit.radiance[0].y, 3.0 * std::sqrt(4.0 * kPi), 0.003 * lit.radiance[0].y);
    EXPECT_FALSE(lit.inside());
    links.links.assign(links.links.size(), shader::kLinkBack);
    const Probe dark = gatherProbes(links, {.radiance = radiance}).at(0);
    EXPECT_TRUE(dark.inside());
    EXPECT_EQ(dark.radiance[0].y, 0.0);
}

} // namespace
} // namespace relume
