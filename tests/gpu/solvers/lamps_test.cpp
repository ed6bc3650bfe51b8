// Analytic lights are held against closed forms and second integrations, in every method.
#include "assets/generate/generate.h"
#include "tests/gpu/bake_comparison.h"
#include "tests/gpu/bake_scene.h"
#include "tests/unit/closed_forms.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include <glm/gtc/matrix_transform.hpp>

namespace relume {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr uint32_t kFloorTexels = 16;
constexpr float kSide = 4.0f; // of the floor [m]

struct Floor {
    SceneMaker maker{32};
    TexelRect rect;
    Scene scene;
    explicit Floor(const Light* light = nullptr) {
        rect = maker.quad({-kSide / 2, -kSide / 2, 0}, kSide * kX, kSide * kY, maker.material(0.0f),
                          glm::uvec2(kFloorTexels));
        scene = maker.scene();
        if (light != nullptr) scene.lights.push_back(*light);
    }
    /// Bakes the light in the middles of the texels, of which the closed forms are.
    FloatImage bake(Method method, uint32_t samples = 16) const {
        return bakeScene(scene, {.size = maker.size(),
                                 .passes = 1,
                                 .allOver = false,
                                 .method = method,
                                 .samples = samples})
            .lighting;
    }
};

glm::dvec3 placeOf(uint32_t column, uint32_t row) {
    const double texel = double{kSide} / kFloorTexels;
    return {(column + 0.5) * texel - kSide / 2, (row + 0.5) * texel - kSide / 2, 0};
}

/// Expects of every texel of the floor what `exact` says, within this share of it.
void expectFloor(const Floor& floor, const FloatImage& lighting,
                 const std::function<double(glm::dvec3)>& exact, double tolerance) {
    for (uint32_t row = 0; row < kFloorTexels; ++row) {
        for (uint32_t column = 0; column < kFloorTexels; ++column) {
            const double wanted = exact(placeOf(column, row));
            EXPECT_NEAR(texel(lighting, floor.rect, column, row), wanted, tolerance * wanted + 1e-6)
                << column << ", " << row;
        }
    }
}

/// Returns a light at `position` that shines down.
Light lightAt(LightType type, glm::vec3 position, float intensity) {
    Light light;
    light.type = type;
    light.transform = glm::translate(glm::mat4(1.0f), position);
    light.intensity = intensity;
    return light;
}

double pointLighting(glm::dvec3 position, glm::dvec3 p, double candela) {
    const glm::dvec3 d = position - p;
    return candela * d.z / (kPi * std::pow(glm::length(d), 3));
}

const Method kMethods[] = {Method::Pure,     Method::Static,      Method::MonteCarlo, Method::Mipmapped,
                           Method::Adaptive, Method::Directional, Method::Hybrid};

class LampMethods : public testing::TestWithParam<Method> {};
INSTANTIATE_TEST_SUITE_P(All, LampMethods, testing::ValuesIn(kMethods),
                         [](const auto& test) { return std::string(methodName(test.param)); });

} // namespace

TEST_P(LampMethods, APointFallsWithTheSquareOfTheDistance) {
    const Light light = lightAt(LightType::Point, {0.3f, -0.2f, 1.5f}, 100.0f);
    const Floor floor(&light);
    expectFloor(
        floor, floor.bake(GetParam()),
        [](glm::dvec3 p) {
            return pointLighting({0.3, -0.2, 1.5}, p, 100);
        },
        1e-4);
}

TEST_P(LampMethods, TheSunGivesItsLux) {
    Light sun = lightAt(LightType::Directional, {0, 0, 0}, 50'000.0f);
    sun.transform = glm::rotate(glm::mat4(1.0f), 0.6f, glm::vec3(1, 0, 0));
    sun.angle = 0.0093f;
    const Floor floor(&sun);
    expectFloor(
        floor, floor.bake(GetParam()), [](glm::dvec3) { return 50'000 * std::cos(0.6) / kPi; }, 1e-4);
}

TEST_P(LampMethods, AnOpenPlaneUnderAConstantSkyGetsPiTimesItsRadiance) {
    Floor floor;
    floor.scene.sky.radiance = {3, 3, 3};
    expectFloor(
        floor, floor.bake(GetParam()), [](glm::dvec3) { return 3.0; }, 1e-5);
}

// Inside a white ball everything is lit alike, by the light and over and over by itself.
TEST_P(LampMethods, BouncesOfALampFollow) {
    constexpr float kAlbedo = 0.5f, kRadius = 1.5f;
    SceneMaker maker(64);
    const int grey = maker.material(kAlbedo);
    maker.sphere({1, 2, 3}, kRadius, {grey, grey, grey, grey, grey, grey}, 18);
    Scene scene = maker.scene();
    scene.lights.push_back(lightAt(LightType::Point, {1, 2, 3}, 10.0f));
    const Baked baked = bakeScene(
        scene,
        {.size = maker.size(), .passes = 12, .method = GetParam(), .samples = 64, .pairs = {.window = 1}});
    const double direct = 10.0 / (kPi * kRadius * kRadius);
    const TexelStatistics all = statistics(baked.lighting, {0, 0, maker.size(), maker.size()});
    EXPECT_NEAR(all.mean / (direct / (1 - kAlbedo)), 1.0, 0.02);
}

TEST(Lamps, ASpotEndsAtItsConeAndAnyLampAtItsRange) {
    Light spot = lightAt(LightType::Spot, {0, 0, 2}, 100.0f);
    spot.innerConeAngle = 0.3f;
    spot.outerConeAngle = 0.5f;
    spot.range = 2.2f;
    const Floor floor(&spot);
    expectFloor(
        floor, floor.bake(Method::Hybrid),
        [](glm::dvec3 p) {
            const double d = std::hypot(p.x, p.y, 2.0), cosine = 2.0 / d;
            const double edge =
                std::clamp((cosine - std::cos(0.5)) / (std::cos(0.3) - std::cos(0.5)), 0.0, 1.0);
            return pointLighting({0, 0, 2}, p, 100) * edge * edge * std::max(0.0, 1 - std::pow(d / 2.2, 4));
        },
        1e-3);
}

TEST(Lamps, ASphereAboveTheHorizonLightsLikeItsCentre) {
    Light bulb = lightAt(LightType::Point, {0, 0, 1.5f}, 100.0f);
    bulb.radius = 0.4f;
    const Floor floor(&bulb);
    expectFloor(
        floor, floor.bake(Method::Hybrid),
        [](glm::dvec3 p) {
            return pointLighting({0, 0, 1.5}, p, 100);
        },
        1e-4);
}

// The sphere is half sunk into the floor's plane, and only the upper half's light counts. It is integrated
// over directions.
TEST(Lamps, ASphereOnTheHorizonIsCutByIt) {
    Light bulb = lightAt(LightType::Point, {0, 0, 0}, 100.0f);
    bulb.radius = 0.5f;
    SceneMaker maker(16);
    const TexelRect rect =
        maker.quad({1, -0.1f, 0}, 0.2f * kX, 0.2f * kY, maker.material(0.0f), glm::uvec2(4));
    Scene scene = maker.scene();
    scene.lights.push_back(bulb);
    const Baked baked =
        bakeScene(scene, {.size = maker.size(), .passes = 1, .method = Method::Hybrid, .samples = 4096});
    const double radiance = 100 / (kPi * 0.25), distance = std::hypot(1.025, 0.025);
    const double cosMost = std::sqrt(1 - 0.25 / (distance * distance));
    double sum = 0; // of cos over the half cone around the horizontal direction
    constexpr int kSteps = 400;
    for (int i = 0; i < kSteps; ++i) {
        const double cosine = 1 - (i + 0.5) / kSteps * (1 - cosMost), sine = std::sqrt(1 - cosine * cosine);
        for (int k = 0; k < kSteps; ++k)
            sum += std::max(0.0, sine * std::sin(2 * kPi * (k + 0.5) / kSteps));
    }
    const double exact = radiance / kPi * sum / (kSteps * kSteps) * 2 * kPi * (1 - cosMost);
    EXPECT_NEAR(texel(baked.lighting, rect, 0, 1) / exact, 1.0, 0.01);
}

TEST(Lamps, ARectangleHasItsFormFactor) {
    Light panel = lightAt(LightType::Rectangle, {0, 0, 1}, 7.0f);
    panel.size = {0.8f, 1.2f};
    const Floor floor(&panel);
    expectFloor(
        floor, floor.bake(Method::Hybrid),
        [](glm::dvec3 p) {
            return 7 * closed::integratedParallelogram({p.x, p.y, p.z}, {0, 0, 1}, {-0.4, -0.6, 1},
                                                       {0, 1.2, 0}, {0.8, 0, 0}, 1e-7);
        },
        1e-3);
}

TEST(Lamps, ADiscHasItsFormFactor) {
    Light disc = lightAt(LightType::Disc, {kSide / 2 / kFloorTexels, kSide / 2 / kFloorTexels, 1}, 7.0f);
    disc.radius = 0.5f;
    const Floor floor(&disc);
    const FloatImage lighting = floor.bake(Method::Hybrid, 1024);
    EXPECT_NEAR(texel(lighting, floor.rect, kFloorTexels / 2, kFloorTexels / 2),
                7 * closed::pointToDisc(0.5, 1.0), 0.005 * 7);
}

// A wall hides half of the disc in the sky from a texel in the middle of its shadow's edge.
TEST(Lamps, TheSunsDiscMakesSoftEdges) {
    constexpr float kAngle = 0.4f;
    Light sun = lightAt(LightType::Directional, {0, 0, 0}, 1000.0f);
    sun.angle = kAngle;
    SceneMaker maker(32);
    const TexelRect rect =
        maker.quad({-1, -0.5f, 0}, 2.0f * kX, kY, maker.material(0.0f), glm::uvec2(20, 10));
    maker.blocker({-9, -9, 2}, 18.0f * kY, 9.0f * kX, maker.material(0.0f));
    Scene scene = maker.scene();
    scene.lights.push_back(sun);
    const FloatImage lighting =
        bakeScene(scene, {.size = maker.size(), .passes = 1, .method = Method::Hybrid, .samples = 1024})
            .lighting;
    const double half = std::tan(kAngle / 2);
    for (uint32_t column = 0; column < rect.width; ++column) {
        const double x = -1 + (column + 0.5) * 0.1, t = std::clamp(x / (2 * half), -1.0, 1.0);
        // This is the share of a disc on one side of a chord.
        const double share = 0.5 + (t * std::sqrt(1 - t * t) + std::asin(t)) / kPi;
        EXPECT_NEAR(texel(lighting, rect, column, 5) / (1000 / kPi), share, 0.015) << column;
    }
}

// There is a small bright spot beside a dim rest, turned: only sampling by brightness finds it.
TEST(Lamps, ASkyPictureIsSampledByBrightness) {
    constexpr uint32_t kWidth = 64, kHeight = 32;
    Floor floor;
    Sky& sky = floor.scene.sky;
    sky.radiance = {2, 1, 0.5f};
    sky.width = kWidth;
    sky.height = kHeight;
    sky.rotation = 0.8f;
    sky.pixels.assign(kWidth * kHeight, glm::vec3(0.1f));
    sky.pixels[8 * kWidth + 40] = {500, 500, 500};
    // The floor's normal, +Z, lies in the picture at its edges; this integrates pixel by pixel.
    double exact = 0;
    constexpr int kFine = 8;
    for (uint32_t row = 0; row < kHeight * kFine; ++row) {
        const double polar = kPi * (row + 0.5) / (kHeight * kFine);
        for (uint32_t column = 0; column < kWidth * kFine; ++column) {
            const double angle = 2 * kPi * ((column + 0.5) / (kWidth * kFine) - 0.5) - 0.8;
            const double z = -std::sin(polar) * std::cos(angle);
            exact += std::max(0.0, z) * sky.pixels[row / kFine * kWidth + column / kFine].g * std::sin(polar);
        }
    }
    exact *= 2 * kPi * kPi / (kWidth * kFine * kHeight * kFine) / kPi;
    const FloatImage lighting = floor.bake(Method::Hybrid, 1024);
    const TexelStatistics all = statistics(lighting, floor.rect);
    EXPECT_NEAR(all.mean / exact, 2.0, 0.01); // of red
    EXPECT_LT((all.max - all.min) / all.mean, 0.2);
}

// Mesh lights, analytic lights and the sky count once in every method: together they give the sum of what
// each gives alone.
TEST_P(LampMethods, LightsAddUp) {
    Scene scene = generateScene("cornell_small");
    const auto bake = [&](const Scene& s) {
        return bakeScene(s,
                         {.size = 32,
                          .passes = 3,
                          .method = GetParam(),
                          .samples = 256,
                          .pairs = {.window = 1, .threshold = 0.03}}) // its nodes differ from light to light
            .lighting;
    };
    const FloatImage emitters = bake(scene);
    Scene dark = scene;
    for (Material& material : dark.materials)
        material.emission = glm::vec3(0.0f);
    dark.lights.push_back(lightAt(LightType::Point, {0, 0.5f, 0}, 3.0f));
    dark.sky.radiance = {0.5f, 0.5f, 0.5f};
    const FloatImage lamps = bake(dark);
    scene.lights = dark.lights;
    scene.sky = dark.sky;
    const FloatImage both = bake(scene);
    FloatImage sum = emitters;
    for (size_t k = 0; k < sum.planes.size(); ++k) {
        if (sum.channels[k] == "coverage") continue;
        for (size_t i = 0; i < sum.planes[k].size(); ++i)
            sum.planes[k][i] += lamps.planes[k][i];
    }
    EXPECT_GT(statistics(lamps, {0, 0, 32, 32}).mean, 0.01);
    EXPECT_LT(relativeError(both, sum), 0.01);
}

TEST(Lamps, DarkOnesAreNoLamps) {
    Floor floor;
    floor.scene.lights.push_back(lightAt(LightType::Point, {0, 0, 1}, 0.0f));
    const FloatImage lighting = floor.bake(Method::Directional);
    EXPECT_EQ(statistics(lighting, floor.rect).max, 0.0);
}

} // namespace relume
