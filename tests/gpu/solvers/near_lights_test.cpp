// Lights near large texels: what a texel has is the mean over it, not the light in its middle.
#include "tests/gpu/bake_scene.h"
#include "tests/gpu/light_at.h"
#include "tests/unit/closed_forms.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

namespace relume {
namespace {

constexpr uint32_t kFloorEdge = 16;
constexpr double kFloorSide = 4, kFloorTexel = kFloorSide / kFloorEdge; // [m]
constexpr float kHeight = 0.12f;          // of the light above the floor [m]: half a texel
constexpr glm::vec2 kFoot{0.31f, -0.17f}; // below its middle

/// Makes a floor that sends nothing back.
struct NearLight {
    SceneMaker maker{32};
    TexelRect rect = maker.quad({-kFloorSide / 2, -kFloorSide / 2, 0}, float(kFloorSide) * kX,
                                float(kFloorSide) * kY, maker.material(0.0f), glm::uvec2(kFloorEdge));
    Scene scene;

    /// Expects of every texel the mean of this light, and of all together, too.
    void expect(const std::string& solver, const std::function<double(glm::dvec2)>& exact,
                double tolerance) const {
        const FloatImage lighting =
            bakeScene(scene, {.size = maker.size(),
                              .passes = 1,
                              .method = solver == "directional" ? Method::Directional : Method::Hybrid,
                              .samples = 4096,
                              .layers = solver == "layers"})
                .lighting;
        const double noise = 2e-5 * exact(kFoot); // where a spot lights but a corner of a texel
        double all = 0, allWanted = 0;
        for (uint32_t row = 0; row < kFloorEdge; ++row) {
            for (uint32_t column = 0; column < kFloorEdge; ++column) {
                const double found = texel(lighting, rect, column, row), wanted = meanOf(exact, column, row);
                EXPECT_NEAR(found, wanted, tolerance * wanted + noise) << column << ", " << row;
                all += found;
                allWanted += wanted;
            }
        }
        EXPECT_NEAR(all, allWanted, 0.3 * tolerance * allWanted);
    }

private:
    // Returns the mean over a texel by the midpoint rule.
    static double meanOf(const std::function<double(glm::dvec2)>& exact, uint32_t column, uint32_t row) {
        constexpr uint32_t kParts = 48;
        double sum = 0;
        for (uint32_t i = 0; i < kParts * kParts; ++i)
            sum += exact({(column + (i % kParts + 0.5) / kParts) * kFloorTexel - kFloorSide / 2,
                          (row + (i / kParts + 0.5) / kParts) * kFloorTexel - kFloorSide / 2});
        return sum / (kParts * kParts);
    }
};

double pointLighting(glm::dvec2 p, double candela) {
    const glm::dvec3 d(glm::dvec2(kFoot) - p, kHeight);
    return candela * d.z / (closed::kPi * std::pow(glm::length(d), 3));
}

constexpr glm::dvec2 kPanel{0.3, 0.2}; // [m]

// The panel is the sum of four rectangles with a corner above the point; those that reach beyond it are
// negative.
double panelLighting(glm::dvec2 p, double radiance) {
    const auto quarter = [](double a, double b) {
        const double sign = (a < 0 ? -1 : 1) * (b < 0 ? -1 : 1);
        return sign * closed::pointToParallelRectangle(std::abs(a), std::abs(b), kHeight);
    };
    const glm::dvec2 d = glm::dvec2(kFoot) - p, hi = d + 0.5 * kPanel, lo = d - 0.5 * kPanel;
    return radiance * (quarter(hi.x, hi.y) - quarter(lo.x, hi.y) - quarter(hi.x, lo.y) + quarter(lo.x, lo.y));
}

class NearLights : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(All, NearLights, testing::Values("directional", "hybrid", "layers"),
                         [](const auto& test) { return std::string(test.param); });

} // namespace

TEST_P(NearLights, ASphereLightsTexelsByTheirMean) {
    NearLight near;
    near.scene = near.maker.scene();
    near.scene.lights.push_back(lightAt(LightType::Point, glm::vec3(kFoot, kHeight), 100.0f, "Bulb"));
    near.scene.lights.back().radius = 0.05f;
    near.expect(
        GetParam(), [](glm::dvec2 p) { return pointLighting(p, 100); }, 0.02);
}

TEST_P(NearLights, ASpotLightsTexelsByTheirMean) {
    NearLight near;
    near.scene = near.maker.scene();
    Light spot = lightAt(LightType::Spot, glm::vec3(kFoot, kHeight), 100.0f, "Spot");
    spot.radius = 0.03f;
    spot.innerConeAngle = 0.3f;
    spot.outerConeAngle = 1.2f;
    near.scene.lights.push_back(spot);
    near.expect(
        GetParam(),
        [](glm::dvec2 p) {
            const double cosine = kHeight / glm::length(glm::dvec3(glm::dvec2(kFoot) - p, kHeight));
            const double edge =
                std::clamp((cosine - std::cos(1.2)) / (std::cos(0.3) - std::cos(1.2)), 0.0, 1.0);
            return pointLighting(p, 100) * edge * edge;
        },
        0.03);
}

TEST_P(NearLights, ARectangleLightsTexelsByTheirMean) {
    NearLight near;
    near.scene = near.maker.scene();
    Light panel = lightAt(LightType::Rectangle, glm::vec3(kFoot, kHeight), 7.0f, "Panel");
    panel.size = kPanel;
    near.scene.lights.push_back(panel);
    near.expect(
        GetParam(), [](glm::dvec2 p) { return panelLighting(p, 7); }, 0.02);
}

TEST_P(NearLights, APolygonLightsTexelsByItsMean) {
    if (GetParam() == std::string("directional")) GTEST_SKIP() << "it finds mesh lights by chance";
    NearLight near;
    near.maker.quad({kFoot.x - 0.15f, kFoot.y + 0.1f, kHeight}, 0.3f * kX, -0.2f * kY,
                    near.maker.material(0.0f, 7.0f), glm::uvec2(2));
    near.scene = near.maker.scene();
    near.expect(
        GetParam(), [](glm::dvec2 p) { return panelLighting(p, 7); }, 0.02);
}

// All of a disc's polygons are sampled. With many others, which light nothing, every sample pass picks some,
// but in layers.
TEST_P(NearLights, ManyPolygonsLightTexelsByTheirMean) {
    if (GetParam() == std::string("directional")) GTEST_SKIP() << "it finds mesh lights by chance";
    for (const uint32_t others : {0u, 256u}) {
        if (others > 0 && GetParam() == std::string("layers")) continue; // it would have as many
        NearLight near;
        const int lit = near.maker.material(0.0f, 7.0f);
        near.maker.disc(glm::vec3(kFoot, kHeight), 0.2f * kX, -0.2f * kY, lit, 4);
        for (uint32_t i = 0; i < others; ++i)
            near.maker.blocker({0.0f, 0.0f, -1.0f - float(i)}, 0.1f * kY, 0.1f * kX, lit);
        near.scene = near.maker.scene();
        near.expect(
            GetParam(),
            [](glm::dvec2 p) {
                return 7 * closed::pointToParallelDisc(glm::distance(p, glm::dvec2(kFoot)), 0.2, kHeight);
            },
            0.03);
    }
}

// A panel stands upon the floor: rays start as close to it as one likes, and what is closest decides what
// little is known of the others where points near it are not picked as often as they shine.
TEST(NearLights, APanelThatTouchesTheFloorIsNoNoisierThanAnother) {
    SceneMaker maker(32);
    const TexelRect rect = maker.quad({0, -1, 0}, kX, 2.0f * kY, maker.material(0.0f), glm::uvec2(8, 16));
    Scene scene = maker.scene();
    Light panel;
    panel.type = LightType::Rectangle;
    panel.intensity = 10.0f;
    panel.size = {4.0f, 2.0f};
    // It shines along its -Z, which is X here; its lower edge is the Y axis.
    panel.transform =
        glm::mat4(glm::vec4(-kY, 0), glm::vec4(kZ, 0), glm::vec4(-kX, 0), glm::vec4(0, 0, 1, 1));
    scene.lights = {panel};
    const auto bake = [&](uint32_t samples) {
        return bakeScene(scene,
                         {.size = maker.size(), .passes = 1, .method = Method::Hybrid, .samples = samples})
            .lighting;
    };
    const FloatImage few = bake(64), many = bake(16384);
    for (uint32_t row = 2; row < 14; ++row) {
        const double wanted = texel(many, rect, 0, row);
        EXPECT_GT(wanted, 4.0) << "about half of what a panel overhead would bring";
        EXPECT_NEAR(texel(few, rect, 0, row) / wanted, 1.0, 0.12) << row;
    }
}

// A thin strip stands upon the floor. What a texel has of it hangs on where rays start, which is another
// place in each replicate: all of them see all of the strip, and are off all the same.
TEST(NearLights, AStripTellsHowFarOffItsTexelsAre) {
    for (const bool layers : {false, true}) {
        NearLight near;
        const int lit = near.maker.material(0.0f, 10.0f);
        near.maker.blocker({-1.5f, 0.1f, 0}, 0.03f * kZ, 3.0f * kX, lit);
        near.scene = near.maker.scene();
        const auto bake = [&](uint32_t samples) {
            return bakeScene(near.scene, {.size = near.maker.size(),
                                          .passes = 1,
                                          .method = Method::Hybrid,
                                          .samples = samples,
                                          .layers = layers});
        };
        const Baked few = bake(64), many = bake(8192);
        const double truly = relativeError(few.lighting, many.lighting);
        EXPECT_GT(truly, 0.02);
        EXPECT_NEAR(few.progress.error / truly, 1.0, 0.4) << layers;
    }
}

} // namespace relume
