// The spread of the points that samples start from, and means of light over it.
#include "bake/base/shader_types.h"
#include "tests/unit/closed_forms.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

namespace relume {
namespace {

using shader::Patch;
using shader::PatchCover;
using shader::TexelSpread;

const glm::vec3 kDu(0.9f, 0.2f, 0.1f), kDv(-0.3f, 0.8f, 0.2f); // [m], a skewed texel

Patch patchAt(const glm::vec3& position, uint32_t texel) {
    Patch p{};
    p.position = position;
    p.area = 0.6f;
    p.flags = shader::kPatchSends | texel << shader::kTexelShift;
    return p;
}

PatchCover coverOf(uint32_t cells, uint32_t u, uint32_t v) {
    return {kDu, cells, kDv, u | v << 16};
}

constexpr uint32_t kMiddle = shader::kCoverPlaces / 2;
constexpr uint32_t kWhole = shader::kCoverCells | shader::kCoverWhole;

// Returns the mean of a function over many points that samples start from.
double sampledMean(const Patch& p, const PatchCover& c, const std::function<double(glm::vec3)>& f) {
    constexpr uint32_t kPoints = 1 << 14;
    double sum = 0;
    for (uint32_t number = 0; number < kPoints; ++number)
        sum += f(shader::startPoint(p, c, number));
    return sum / kPoints;
}

double spreadMean(const TexelSpread& t, const std::function<double(glm::vec3)>& f) {
    double sum = 0;
    for (uint32_t i = 0; i < shader::kSpreadPoints; ++i)
        sum += f(shader::spreadPoint(t, i));
    return sum / shader::kSpreadPoints;
}

TEST(TexelSpread, HasTheMeanAndCovarianceOfTheStarts) {
    std::mt19937 random(3);
    for (uint32_t round = 0; round < 40; ++round) {
        const uint32_t cells =
            round == 0 ? kWhole : (random() & random() & shader::kCoverCells) | 1u << round % 25;
        const Patch p = patchAt({1, 2, 3}, 977 * round);
        const PatchCover c = coverOf(cells, random() % shader::kCoverPlaces, random() % shader::kCoverPlaces);
        const TexelSpread t = shader::texelSpread(p, c);
        EXPECT_NEAR(t.size, std::sqrt(0.6f), 1e-6f);
        for (int i = 0; i < 3; ++i) {
            const double mean = sampledMean(p, c, [&](glm::vec3 x) { return x[i]; });
            EXPECT_NEAR(t.middle[i], mean, 1e-3) << cells;
            for (int k = 0; k <= i; ++k) {
                const auto product = [&](glm::vec3 x) { return (x[i] - mean) * double(x[k] - t.middle[k]); };
                EXPECT_NEAR(spreadMean(t, product), sampledMean(p, c, product), 1e-3) << cells;
            }
        }
    }
}

TEST(TexelSpread, HasTheMeanOfCubicsOverAWholeTexel) {
    const Patch p = patchAt({0, 0, 0}, 5);
    const PatchCover c{{1, 0, 0}, kWhole, {0, 1, 0}, kMiddle | kMiddle << 16};
    const TexelSpread t = shader::texelSpread(p, c);
    // The texel reaches from -1/2 to 1/2: means of odd powers are 0, and of squares 1/12.
    const auto cubic = [](glm::vec3 x) {
        const double u = x.x, v = x.y;
        return 1 + 2 * u - 3 * v + 5 * u * u - 7 * u * v + 11 * v * v + 13 * u * u * u - 17 * u * u * v +
               v * v * v;
    };
    EXPECT_NEAR(spreadMean(t, cubic), 1 + 16.0 / 12, 1e-6);
}

TEST(TexelSpread, OfAPatchThatDoesNotMoveIsItsPoint) {
    const TexelSpread t = shader::texelSpread(patchAt({1, 2, 3}, 5), PatchCover{});
    EXPECT_EQ(t.middle, glm::vec3(1, 2, 3));
    EXPECT_EQ(shader::spreadPoint(t, 0), glm::vec3(1, 2, 3));
    EXPECT_EQ(t.size, 0.0f);
    EXPECT_EQ(shader::unevenness(t.size, 0.0f), shader::kLightEven);
}

// Light of a point falls fastest at its feet. Where four points are taken to tell its mean they do to 2 %,
// and where the middle alone is, that does to 0.3 %.
TEST(TexelSpread, TellsTheMeanOfTheLightOfAPoint) {
    const PatchCover c{{1, 0, 0}, kWhole, {0, 1, 0}, kMiddle | kMiddle << 16};
    Patch p = patchAt({0, 0, 0}, 5);
    p.area = 1.0f;
    const TexelSpread t = shader::texelSpread(p, c);
    for (const glm::vec3 way : {glm::vec3(0, 0, 1), glm::normalize(glm::vec3(1, 0, 0.1f)),
                                glm::normalize(glm::vec3(1, 1, 1)), glm::normalize(glm::vec3(1, 1, 0.2f))}) {
        for (const float distance : {2.01f, 4.0f, 8.0f, 15.9f, 16.1f, 40.0f}) {
            const auto light = [&](glm::vec3 x) {
                const glm::vec3 d = distance * way - x;
                return double(d.z) / std::pow(glm::length(d), 3.0f);
            };
            const bool even = shader::unevenness(t.size, distance) == shader::kLightEven;
            EXPECT_EQ(even, distance > 16);
            const double mean = sampledMean(p, c, light);
            const double told = even ? light(t.middle) : spreadMean(t, light);
            EXPECT_NEAR(told, mean, (distance > 4 ? 0.003 : 0.02) * mean) << distance << " m";
        }
    }
    EXPECT_EQ(shader::unevenness(t.size, 1.99f), shader::kLightUneven);
}

// A spot whose edge is sharper than a texel is uneven there however far it is.
TEST(TexelSpread, MeetsTheEdgeOfASpot) {
    shader::Lamp spot{};
    spot.type = shader::kLampSpot;
    spot.position = {0, 0, 10};
    spot.axis = {0, 0, -1};
    const auto setEdge = [&](float inner, float outer) {
        spot.coneScale = 1 / (std::cos(inner) - std::cos(outer));
        spot.coneOffset = -std::cos(outer) * spot.coneScale;
    };
    setEdge(0.49f, 0.5f);
    const float edge = 10 * std::tan(0.5f);
    EXPECT_EQ(shader::lampUnevenness(spot, {edge, 0, 0}, 0.5f), shader::kLightUneven);
    EXPECT_EQ(shader::lampUnevenness(spot, {edge, 0, 0}, 0.0f), shader::kLightEven);
    EXPECT_EQ(shader::lampUnevenness(spot, {0, 0, 0}, 0.5f), shader::kLightEven);
    EXPECT_EQ(shader::lampUnevenness(spot, {3 * edge, 0, 0}, 0.5f), shader::kLightEven);
    setEdge(0.1f, 1.0f);
    EXPECT_EQ(shader::lampUnevenness(spot, {edge, 0, 0}, 0.5f), shader::kLightCurved);
    EXPECT_EQ(shader::lampUnevenness(spot, {edge, 0, 0}, 0.2f), shader::kLightEven);
    // Along the axis of a narrow beam the cosine hardly changes.
    setEdge(0.0999f, 0.1f);
    EXPECT_EQ(shader::lampUnevenness(spot, {0, 0, 0}, 0.07f), shader::kLightEven);
    EXPECT_EQ(shader::lampUnevenness(spot, {1.0f, 0, 0}, 0.07f), shader::kLightUneven);
}

// A long panel is near where it is, not all around its middle.
TEST(TexelSpread, IsNearARectangleAlongIt) {
    shader::Lamp panel{};
    panel.type = shader::kLampRectangle;
    panel.position = {0, 0, 1};
    panel.edgeU = {2, 0, 0};
    panel.edgeV = {0, 0.1f, 0};
    EXPECT_FLOAT_EQ(shader::rectangleDistance(panel, panel.position - glm::vec3(0.9f, 0, 0)), 1.0f);
    EXPECT_FLOAT_EQ(shader::rectangleDistance(panel, panel.position - glm::vec3(4, 0, 5)), 5.0f);
    EXPECT_FLOAT_EQ(shader::rectangleDistance(panel, panel.position - glm::vec3(0, 0.55f, 1)), 0.5f);
    EXPECT_EQ(shader::lampUnevenness(panel, {0.9f, 0, 0.9f}, 0.1f), shader::kLightUneven);
    EXPECT_EQ(shader::lampUnevenness(panel, {0, 0.5f, 1}, 0.1f), shader::kLightCurved);
}

// A polygon whose plane cuts a texel shines on the part before it, where four points may all lie behind.
TEST(TexelSpread, IsShoneOnByAPolygonBeforeAPartOfIt) {
    const PatchCover c{{1, 0, 0}, kWhole, {0, 1, 0}, kMiddle | kMiddle << 16};
    Patch p = patchAt({0, 0, 0}, 5);
    p.area = 1.0f;
    const TexelSpread t = shader::texelSpread(p, c);
    const glm::vec3 up(0, 0, 1), along(-1, 1, 0);
    const auto wall = [&](float x) { // stands at this place of both axes and shines away from the origin
        shader::EmitterPolygon e{};
        const glm::vec3 foot(x, x, 0.1f);
        e.c0 = foot - along, e.c1 = foot + along, e.c2 = e.c1 + up, e.c3 = e.c0 + up;
        return e;
    };
    EXPECT_GT(shader::emitterFormFactor({0.49f, 0.49f, 0}, up, wall(0.45f)), 0.0f);
    EXPECT_EQ(shader::spreadFormFactor(t, up, wall(0.45f)), 0.0f);
    EXPECT_TRUE(shader::mayShineOn(t, up, wall(0.45f)));
    EXPECT_FALSE(shader::mayShineOn(t, up, wall(0.55f)));
    EXPECT_FALSE(shader::mayShineOn(t, -up, wall(0.45f)));
}

} // namespace
} // namespace relume
