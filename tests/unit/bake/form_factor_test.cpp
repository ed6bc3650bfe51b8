#include "bake/base/shader_types.h"

#include "tests/unit/closed_forms.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <random>

namespace relume {
namespace {

using closed::Vec;
using glm::vec3;
using namespace closed;

vec3 toFloat(const Vec& a) {
    return vec3(float(a[0]), float(a[1]), float(a[2]));
}
Vec toDouble(const vec3& a) {
    return {a.x, a.y, a.z};
}

float polygon(const Vec& p, const Vec& n, const Vec& corner, const Vec& u, const Vec& v) {
    return shader::polygonFormFactor(toFloat(p), toFloat(n), toFloat(corner), toFloat(corner + u),
                                     toFloat(corner + u + v), toFloat(corner + v));
}

/// Returns the mean of f over the unit square by m x m midpoints.
double meanOverSquare(int m, const std::function<double(double, double)>& f) {
    double sum = 0;
    for (int i = 0; i < m; ++i)
        for (int j = 0; j < m; ++j)
            sum += f((i + 0.5) / m, (j + 0.5) / m);
    return sum / m / m;
}

/// Returns a random rotation, as the images of the axes [Shoemake 1992].
std::array<Vec, 3> randomAxes(std::mt19937& random) {
    std::normal_distribution<double> normal;
    const Vec x = unit({normal(random), normal(random), normal(random)});
    const Vec y = unit(cross(x, unit({normal(random), normal(random), normal(random)})));
    return {x, y, cross(x, y)};
}

TEST(ClosedForms, HaveTheLiteraturesNumbers) {
    EXPECT_NEAR(parallelRectangles(1, 1, 1), 0.19982, 5e-6);
    EXPECT_NEAR(perpendicularRectangles(1, 1, 1), 0.20004, 5e-6);
    EXPECT_NEAR(coaxialDiscs(1, 1, 1), 0.38197, 5e-6);
    EXPECT_NEAR(2 * parallelRectangles(2, 3, 6) + 0, 2 * parallelRectangles(3, 2, 6), 1e-12);
    // In a closed box of 1 x 2 x 3, these go from the floor to the ceiling and four walls.
    EXPECT_NEAR(parallelRectangles(1, 2, 3) + 2 * perpendicularRectangles(1, 3, 2) +
                    2 * perpendicularRectangles(2, 3, 1),
                1.0, 1e-12);
}

TEST(ClosedForms, AgreeWithIntegration) {
    EXPECT_NEAR(pointToParallelRectangle(1, 2, 0.5),
                integratedParallelogram({0, 0, 0}, {0, 0, 1}, {0, 0, 0.5}, {0, 2, 0}, {1, 0, 0}), 1e-7);
    // The plate is at the origin and looks up along z; the wall is in the plane y = 0.5 from z = 0 to 1, x
    // from 0 to 2.
    EXPECT_NEAR(pointToPerpendicularRectangle(1, 2, 0.5),
                integratedParallelogram({0, 0, 0}, {0, 0, 1}, {0, 0.5, 0}, {2, 0, 0}, {0, 0, 1}), 1e-7);
    EXPECT_NEAR(meanOverSquare(200,
                               [](double x, double y) { // C-11 from B-3 by adding four corners
                                   return pointToParallelRectangle(x, y, 1) +
                                          pointToParallelRectangle(1 - x, y, 1) +
                                          pointToParallelRectangle(x, 1 - y, 1) +
                                          pointToParallelRectangle(1 - x, 1 - y, 1);
                               }),
                parallelRectangles(1, 1, 1), 1e-5);
}

TEST(PolygonFormFactor, GivesParallelUnitSquares) {
    const double f = meanOverSquare(64, [](double x, double y) {
        return polygon({x, y, 0}, {0, 0, 1}, {0, 0, 1}, {0, 1, 0}, {1, 0, 0});
    });
    EXPECT_NEAR(f, parallelRectangles(1, 1, 1), 2e-5);
    EXPECT_NEAR(f, 0.19982, 3e-5);
}

TEST(PolygonFormFactor, GivesPerpendicularUnitSquares) {
    const double f = meanOverSquare(512, [](double x, double y) {
        return polygon({x, y, 0}, {0, 0, 1}, {0, 0, 0}, {0, 1, 0}, {0, 0, 1});
    });
    EXPECT_NEAR(f, perpendicularRectangles(1, 1, 1), 2e-5);
    EXPECT_NEAR(f, 0.20004, 3e-5);
}

TEST(PolygonFormFactor, GivesCoaxialDiscs) {
    // Both discs are cut into parallelograms (wedges of rings), with receivers at the radius that halves each
    // ring's area.
    const int rings = 24, wedges = 96;
    double sum = 0, weight = 0;
    for (int k = 0; k < 32; ++k) {
        const Vec p = {std::sqrt((k + 0.5) / 32), 0, 0};
        for (int i = 0; i < rings; ++i)
            for (int j = 0; j < wedges; ++j) {
                const double r0 = double(i) / rings, r1 = double(i + 1) / rings;
                const double a0 = 2 * kPi * j / wedges, a1 = 2 * kPi * (j + 1) / wedges;
                const auto at = [](double r, double a) { return Vec{r * std::cos(a), r * std::sin(a), 1}; };
                sum +=
                    shader::polygonFormFactor(toFloat(p), vec3(0, 0, 1), toFloat(at(r0, a0)),
                                              toFloat(at(r0, a1)), toFloat(at(r1, a1)), toFloat(at(r1, a0)));
            }
        weight += 1;
    }
    // The polygon of 96 sides lacks 0.07 % of the disc's area.
    EXPECT_NEAR(sum / weight, coaxialDiscs(1, 1, 1), 0.001 * 0.38197);
}

TEST(PolygonFormFactor, GivesPointToRectangle) {
    for (double c : {0.01, 0.1, 0.5, 1.0, 4.0})
        for (double a : {0.2, 1.0, 3.0}) {
            const double parallel = pointToParallelRectangle(a, 1, c);
            EXPECT_NEAR(polygon({0, 0, 0}, {0, 0, 1}, {0, 0, c}, {0, 1, 0}, {a, 0, 0}), parallel,
                        1e-4 * parallel);
            const double upright = pointToPerpendicularRectangle(a, 1, c);
            EXPECT_NEAR(polygon({0, 0, 0}, {0, 0, 1}, {0, c, 0}, {1, 0, 0}, {0, 0, a}), upright,
                        1e-4 * upright);
            // Nothing changes where the same wall reaches as far below the horizon.
            EXPECT_NEAR(polygon({0, 0, 0}, {0, 0, 1}, {0, c, -a}, {1, 0, 0}, {0, 0, 2 * a}), upright,
                        1e-4 * upright);
        }
}

TEST(PolygonFormFactor, AgreesWithIntegrationNearAndFar) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> uniform(-1, 1);
    int clipped = 0, whole = 0;
    double worst = 0;
    for (int k = 0; k < 600; ++k) {
        const auto axes = randomAxes(random);
        const double distance = 0.1 * std::pow(40.0, 0.5 + 0.5 * uniform(random)); // 0.1 to 4 patch sizes
        const Vec p = distance * unit({uniform(random), uniform(random), 0.05 + std::abs(uniform(random))});
        const Vec n = unit({uniform(random), uniform(random), uniform(random) - 0.3});
        const auto place = [&](const Vec& a) { return a[0] * axes[0] + a[1] * axes[1] + a[2] * axes[2]; };
        const vec3 pf = toFloat(place(p)), nf = toFloat(place(n));
        const vec3 cf = toFloat(place({-0.5, -0.5, 0})), uf = toFloat(place({1, 0, 0})),
                   vf = toFloat(place({0, 1, 0}));
        const Vec centre = toDouble(cf) + 0.5 * (toDouble(uf) + toDouble(vf));
        const double expected = integratedParallelogram(toDouble(pf), toDouble(nf), toDouble(cf),
                                                        toDouble(uf), toDouble(vf), 1e-9);
        const float exact =
            shader::parallelogramFormFactor(pf, nf, toFloat(centre), uf, vf, glm::cross(uf, vf));
        const float poly = shader::polygonFormFactor(pf, nf, cf, cf + uf, cf + uf + vf, cf + vf);
        const double allowed =
            1e-4 * expected + 2e-7; // slivers above the horizon: their rounding is absolute
        ASSERT_NEAR(exact, expected, allowed) << "case " << k << " distance " << distance;
        ASSERT_NEAR(poly, expected, allowed) << "case " << k << " distance " << distance;
        bool below = false;
        for (double s : {0.0, 1.0})
            for (double t : {0.0, 1.0})
                below |=
                    dot(toDouble(nf), toDouble(cf) + s * toDouble(uf) + t * toDouble(vf) - toDouble(pf)) < 0;
        if (expected > 1e-3) worst = std::max(worst, std::abs(exact - expected) / expected);
        ++(below ? clipped : whole);
    }
    RecordProperty("worstRelativeError", std::to_string(worst));
    EXPECT_LT(worst, 5e-5);
    EXPECT_GT(clipped, 100);
    EXPECT_GT(whole, 100);
}

TEST(PolygonFormFactor, KeepsItsDigitsFarAway) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (double distance : {4.0, 30.0, 300.0})
        for (int k = 0; k < 200; ++k) {
            const auto axes = randomAxes(random);
            const vec3 u = toFloat(axes[0]), v = toFloat(axes[1]);
            const vec3 p = toFloat(distance * unit(Vec{uniform(random), uniform(random), 1}));
            const vec3 s = toFloat(Vec{0, 0, 0});
            const vec3 n = toFloat(unit(Vec{uniform(random), uniform(random), -1.5}));
            const Vec corner = -0.5 * (toDouble(u) + toDouble(v));
            const double expected =
                integratedParallelogram(toDouble(p), toDouble(n), corner, toDouble(u), toDouble(v), 1e-12);
            if (expected < 0.01 / (distance * distance)) continue; // nearly edge on
            EXPECT_NEAR(shader::parallelogramFormFactor(p, n, s, u, v, glm::cross(u, v)) / expected, 1.0,
                        std::max(2e-5, 3e-6 * distance));
        }
}

/// Returns the sum over the five other walls of the unit cube, from a point on the floor; each wall is cut
/// into m x m pieces.
double cubeSum(double x, double y, int m) {
    struct Wall {
        Vec corner, u, v;
    };
    const Wall walls[5] = {{{0, 0, 1}, {0, 1, 0}, {1, 0, 0}},
                           {{0, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                           {{1, 0, 0}, {0, 0, 1}, {0, 1, 0}},
                           {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}},
                           {{0, 1, 0}, {1, 0, 0}, {0, 0, 1}}};
    double sum = 0;
    for (const Wall& wall : walls)
        for (int i = 0; i < m; ++i)
            for (int j = 0; j < m; ++j)
                sum += polygon({x, y, 0}, {0, 0, 1},
                               wall.corner + double(i) / m * wall.u + double(j) / m * wall.v,
                               1.0 / m * wall.u, 1.0 / m * wall.v);
    return sum;
}

TEST(PolygonFormFactor, SumsToOneInACube) {
    for (double x : {0.5, 0.25, 0.01, 1e-3, 1e-4, 1e-6})
        for (double y : {0.5, 0.1, 1e-3, 1e-6})
            for (int m : {1, 8})
                EXPECT_NEAR(cubeSum(x, y, m), 1.0, 1e-5) << x << ' ' << y << ' ' << m;
    EXPECT_NEAR(cubeSum(0.5 / 64, 0.5 / 64, 64), 1.0, 2e-5); // a corner texel of a 64 x 64 map
}

TEST(PolygonFormFactor, TellsItsFrontFromItsBack) {
    const Vec n = {0, 0, 1}, corner = {-0.5, -0.5, 1}, u = {1, 0, 0}, v = {0, 1, 0};
    EXPECT_EQ(polygon({0, 0, 0}, n, corner, u, v), 0.0f); // its front is up, away
    EXPECT_GT(polygon({0, 0, 0}, n, corner, v, u), 0.1f);
    EXPECT_EQ(polygon({0, 0, 0}, {0, 0, -1}, corner, v, u), 0.0f); // below the horizon
    EXPECT_EQ(polygon({0, 0, 1}, {1, 0, 0}, corner, v, u), 0.0f);  // in its plane
    // This quadrilateral is seen from behind, and its part below the horizon is the larger one.
    EXPECT_EQ(polygon({0, 0, 0}, unit({1, 0, -0.1}), corner, u, v), 0.0f);
}

TEST(ParallelogramFormFactor, IsIndependentOfHandedness) {
    const vec3 p(0.1f, 0.2f, 0), n = glm::normalize(vec3(0.3f, -0.2f, 1)), c(0.3f, 0, 0.8f);
    const vec3 u(1, 0.1f, 0.2f), v(0.3f, 0.9f, -0.1f), down(0, 0, -1), up(0, 0, 1);
    const float f = shader::parallelogramFormFactor(p, n, c, u, v, down);
    EXPECT_GT(f, 0.1f);
    EXPECT_NEAR(shader::parallelogramFormFactor(p, n, c, v, u, down), f, 1e-6f);
    EXPECT_NEAR(shader::parallelogramFormFactor(p, n, c, -u, v, down), f, 1e-6f);
    EXPECT_EQ(shader::parallelogramFormFactor(p, n, c, u, v, up), 0.0f);
    EXPECT_EQ(shader::parallelogramFormFactor(p, n, c, v, u, up), 0.0f);
}

TEST(ParallelogramFormFactor, IsTheSameWhereverTheSceneIs) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (int k = 0; k < 300; ++k) {
        const Vec p = {uniform(random), uniform(random), 0.2 + std::abs(uniform(random))};
        const Vec n = unit({uniform(random), uniform(random), -0.5});
        const Vec u = {1, 0.2, 0}, v = {0.1, 0.8, 0};
        const float f = shader::parallelogramFormFactor(toFloat(p), toFloat(n), vec3(0), toFloat(u),
                                                        toFloat(v), vec3(0, 0, 1));
        for (double scale : {0.01, 1.0, 1000.0}) {
            const auto axes = randomAxes(random);
            const Vec shift = scale * Vec{3 * uniform(random), 3 * uniform(random), 3 * uniform(random)};
            const auto turn = [&](const Vec& a) { return a[0] * axes[0] + a[1] * axes[1] + a[2] * axes[2]; };
            const float moved = shader::parallelogramFormFactor(
                toFloat(scale * turn(p) + shift), toFloat(turn(n)), toFloat(shift), toFloat(scale * turn(u)),
                toFloat(scale * turn(v)), toFloat(axes[2]));
            EXPECT_NEAR(moved, f, 1e-5f * f + 1e-6f) << "scale " << scale;
        }
    }
}

TEST(ParallelogramFormFactor, IsContinuousAcrossTheHorizon) {
    // While the receiver turns in small steps, the clipped quadrilateral may jump by no more than a step's
    // worth.
    float last = 0.0f;
    for (int k = 0; k <= 20000; ++k) {
        const float a = 3.14159265f * float(k) / 20000.0f;
        const float f = shader::parallelogramFormFactor(
            vec3(0), vec3(std::cos(a), 0.2f, std::sin(a)) / std::sqrt(1.04f), vec3(0.1f, 0.2f, 0.7f),
            vec3(1, 0, 0), vec3(0, 1, 0), vec3(0, 0, -1));
        ASSERT_NEAR(f, k == 0 ? f : last, 2e-4f) << "step " << k;
        last = f;
    }
}

TEST(FormFactors, AreNeverNan) {
    std::mt19937 random(5);
    // Coordinates come from a small set, so that coinciding and collinear points, edges through p and planes
    // through p are common.
    std::uniform_int_distribution<int> pick(0, 7);
    const float values[8] = {0, 0, 1, -1, 0.5f, 1e-7f, -1e-7f, 1e-3f};
    const vec3 normals[4] = {vec3(0, 0, 1), vec3(0, 1, 0), vec3(-1, 0, 0), glm::normalize(vec3(1, 1, 1))};
    const auto point = [&](float scale) {
        return scale * vec3(values[pick(random)], values[pick(random)], values[pick(random)]);
    };
    for (int k = 0; k < 400000; ++k) {
        const float scale = k % 3 == 0 ? 1e-9f : k % 3 == 1 ? 1.0f : 1e9f;
        const vec3 p = point(scale), n = normals[pick(random) % 4], a = point(scale), b = point(scale),
                   c = point(scale);
        const float area = scale * scale * std::abs(values[pick(random)]);
        const float results[] = {shader::polygonFormFactor(p, n, a, b, c, point(scale)),
                                 shader::parallelogramFormFactor(p, n, a, b, c, normals[pick(random) % 4]),
                                 shader::discFormFactor(p, n, a, normals[pick(random) % 4], area),
                                 shader::rtradFormFactor(p, n, a, -n, area, values[pick(random)])};
        for (float f : results)
            ASSERT_TRUE(f >= 0.0f && f <= 1.0f) << f << " in case " << k;
    }
}

TEST(ArcAngle, AgreesWithAtan2) {
    for (int k = 0; k <= 100000; ++k) {
        const double a = kPi * k / 100000;
        const float s = float(std::sin(a)), c = float(std::cos(a));
        EXPECT_NEAR(shader::arcAngle(s, c), std::atan2(double(s), double(c)), 3e-7);
    }
    EXPECT_EQ(shader::arcAngle(0, 0), 0.0f);
    EXPECT_EQ(shader::arcAngle(0, 3), 0.0f);
    EXPECT_FLOAT_EQ(shader::arcAngle(0, -3), float(kPi));
    EXPECT_NEAR(shader::arcAngle(1e-6f, 1.0f), 1e-6, 1e-13);
}

TEST(DiscFormFactor, IsExactOnTheAxisAndZeroFromBehind) {
    const vec3 up(0, 0, 1), down(0, 0, -1);
    for (double h : {0.1, 1.0, 5.0})
        EXPECT_NEAR(shader::discFormFactor(vec3(0), up, vec3(0, 0, float(h)), down, float(kPi)),
                    pointToDisc(1, h), 1e-6);
    EXPECT_EQ(shader::discFormFactor(vec3(0), up, vec3(0, 0, 1), up, 1), 0.0f);
    EXPECT_EQ(shader::discFormFactor(vec3(0), down, vec3(0, 0, 1), down, 1), 0.0f);
    EXPECT_EQ(shader::discFormFactor(vec3(0), up, vec3(0), down, 1), 0.0f);
    // Far away all forms meet.
    const vec3 s(3, 2, 40), n = glm::normalize(vec3(0.2f, 0.1f, -1));
    const float exact = shader::parallelogramFormFactor(vec3(0), up, s, glm::cross(n, vec3(0, 1, 0)),
                                                        glm::cross(n, glm::cross(n, vec3(0, 1, 0))), n);
    const float area = glm::dot(glm::cross(n, vec3(0, 1, 0)), glm::cross(n, vec3(0, 1, 0)));
    EXPECT_NEAR(shader::discFormFactor(vec3(0), up, s, n, area) / exact, 1.0f, 1e-3f);
    EXPECT_NEAR(shader::rtradFormFactor(vec3(0), up, s, n, area, 1) / exact, 1.0f, 1e-3f);
}

TEST(RtradFormFactor, ClampsAndScalesTheDistance) {
    const vec3 up(0, 0, 1), down(0, 0, -1), s(0, 0, 2);
    EXPECT_FLOAT_EQ(shader::rtradFormFactor(vec3(0), up, s, down, 1, 1), 1 / (4 * float(kPi)));
    EXPECT_FLOAT_EQ(shader::rtradFormFactor(vec3(0), up, s, down, 1, 2), 1 / (16 * float(kPi)));
    EXPECT_EQ(shader::rtradFormFactor(vec3(0), up, s, down, 100, 1), 1.0f);
    EXPECT_EQ(shader::rtradFormFactor(vec3(0), up, s, down, 1, 0), 1.0f);
    EXPECT_EQ(shader::rtradFormFactor(vec3(0), up, s, up, 1, 1), 0.0f);
}

} // namespace
} // namespace relume
