#include "assets/atlas/chart_quality.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

namespace relume {
namespace {

/// Returns the two triangles of the unit square in the plane that x and y span.
std::vector<glm::dvec3> squareIn(const glm::dvec3& x, const glm::dvec3& y) {
    const glm::dvec3 o(0.3, -2.0, 0.7);
    return {o, o + x, o + x + y, o, o + x + y, o + y};
}

std::vector<glm::dvec2> mapped(const glm::dmat2& m) {
    std::vector<glm::dvec2> uv;
    for (const glm::dvec2& p : {glm::dvec2(0, 0), glm::dvec2(1, 0), glm::dvec2(1, 1), glm::dvec2(0, 0),
                                glm::dvec2(1, 1), glm::dvec2(0, 1)})
        uv.push_back(m * p);
    return uv;
}

TEST(ChartQuality, StretchOfAffineMapsIsThatOfTheirSingularValues) {
    const glm::dvec3 x = glm::normalize(glm::dvec3(1, 2, 2)), y = glm::normalize(glm::dvec3(2, -2, 1));
    const std::vector<glm::dvec3> square = squareIn(x, y);
    EXPECT_NEAR(measureStretch(square, mapped(glm::dmat2(1.0))).normalised(), 1.0, 1e-12);
    // A turn and a scale are no stretch.
    EXPECT_NEAR(measureStretch(square, mapped({{0.0, 7.0}, {-7.0, 0.0}})).normalised(), 1.0, 1e-12);
    // With the singular values s and t of the map to the plane, L2 is sqrt((1/s^2 + 1/t^2) / 2), and areas
    // grow by s t.
    for (const auto& [s, t] : {std::array{2.0, 1.0}, std::array{0.5, 3.0}, std::array{1.0, 0.01}}) {
        const double expected = std::sqrt(0.5 * (1 / (s * s) + 1 / (t * t)) * s * t);
        const glm::dmat2 turn(std::cos(0.7), std::sin(0.7), -std::sin(0.7), std::cos(0.7));
        const glm::dmat2 scale(glm::dvec2(s, 0), glm::dvec2(0, t));
        EXPECT_NEAR(measureStretch(square, mapped(turn * scale)).normalised(), expected, 1e-9 * expected);
        EXPECT_NEAR(measureStretch(square, mapped(scale * turn)).normalised(), expected, 1e-9 * expected);
    }
    // A shear by h has s^2 + t^2 = 2 + h^2 and s t = 1.
    EXPECT_NEAR(measureStretch(square, mapped({{1.0, 0.0}, {0.8, 1.0}})).normalised(), std::sqrt(1.0 + 0.32),
                1e-12);
}

TEST(ChartQuality, StretchIsWeightedByArea) {
    // Nine parts of ten are isometric, and one is half as wide.
    std::vector<glm::dvec3> corners = {{0, 0, 0}, {9, 0, 0}, {0, 2, 0}, {0, 0, 1}, {1, 0, 1}, {0, 2, 1}};
    std::vector<glm::dvec2> uv = {{0, 0}, {9, 0}, {0, 2}, {0, 0}, {0.5, 0}, {0, 2}};
    const double squares = 0.9 * 1.0 + 0.1 * 0.5 * (4.0 + 1.0);
    EXPECT_NEAR(measureStretch(corners, uv).normalised(), std::sqrt(squares * 0.95), 1e-12);
}

TEST(ChartQuality, WhatIsTurnedOverHasInfiniteStretch) {
    const std::vector<glm::dvec3> square = squareIn({1, 0, 0}, {0, 1, 0});
    EXPECT_TRUE(std::isinf(measureStretch(square, mapped({{-1.0, 0.0}, {0.0, 1.0}})).squares));
    EXPECT_TRUE(std::isinf(measureStretch(square, mapped({{1.0, 0.0}, {0.0, 0.0}})).squares));
}

std::vector<glm::dvec2> moved(std::vector<glm::dvec2> uv, const glm::dvec2& by) {
    for (glm::dvec2& p : uv)
        p += by;
    return uv;
}

std::vector<glm::dvec2> both(std::vector<glm::dvec2> a, const std::vector<glm::dvec2>& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

TEST(ChartQuality, OverlapIsMoreThanATouch) {
    const std::vector<glm::dvec2> square = mapped(glm::dmat2(1.0));
    EXPECT_FALSE(chartOverlaps(square));
    EXPECT_FALSE(chartOverlaps(both(square, moved(square, {1, 0.25})))); // along a part of an edge
    EXPECT_FALSE(chartOverlaps(both(square, moved(square, {1, 1}))));    // in a corner
    EXPECT_TRUE(chartOverlaps(both(square, moved(square, {0.999, 0.25}))));
    EXPECT_TRUE(chartOverlaps(both(square, moved(square, {0.999, 0.999}))));
    EXPECT_TRUE(chartOverlaps(both(square, square))); // with all edges in common
    EXPECT_TRUE(chartOverlaps(both(square, moved(square, {0.3, 0.3}))));
    const std::vector<glm::dvec2> small = {{0.6, 0.2}, {0.7, 0.2}, {0.7, 0.3}}; // inside
    EXPECT_TRUE(chartOverlaps(both(square, small)));
    // Between two groups only.
    EXPECT_FALSE(chartOverlaps(both(both(square, square), moved(square, {2, 0})), 4));
    EXPECT_TRUE(chartOverlaps(both(both(square, moved(square, {2, 0})), square), 4));
}

TEST(ChartQuality, AFanThatGoesAroundTwiceCoversItself) {
    for (const double turns : {0.99, 1.01, 2.0}) {
        for (const int steps : {12, 3000}) { // of which many are thin, and counted in cells
            std::vector<glm::dvec2> uv;
            for (int i = 0; i < steps; ++i) {
                const double a = turns * 6.283185307 * i / steps, b = turns * 6.283185307 * (i + 1) / steps;
                uv.insert(uv.end(), {{0, 0}, {std::cos(a), std::sin(a)}, {std::cos(b), std::sin(b)}});
            }
            EXPECT_EQ(chartOverlaps(uv), turns > 1.0) << turns << " turns in " << steps;
        }
    }
}

double signedArea(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Returns twice the area that two counter-clockwise triangles have in common, by clipping one with the
/// other's edges.
double commonArea(const glm::dvec2* a, const glm::dvec2* b) {
    std::vector<glm::dvec2> polygon(a, a + 3);
    for (int k = 0; k < 3; ++k) {
        const glm::dvec2 &from = b[k], &to = b[(k + 1) % 3];
        std::vector<glm::dvec2> kept;
        for (size_t i = 0; i < polygon.size(); ++i) {
            const glm::dvec2 &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
            const double dp = signedArea(from, to, p), dq = signedArea(from, to, q);
            if (dp >= 0.0) kept.push_back(p);
            if ((dp < 0.0) != (dq < 0.0)) kept.push_back(p + (q - p) * (dp / (dp - dq)));
        }
        polygon = kept;
    }
    double twice = 0.0;
    for (size_t i = 1; i + 1 < polygon.size(); ++i)
        twice += signedArea(polygon[0], polygon[i], polygon[i + 1]);
    return twice;
}

TEST(ChartQuality, OverlapIsThatOfClippedPolygons) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    int overlapping = 0;
    for (int round = 0; round < 3000; ++round) {
        std::vector<glm::dvec2> uv;
        const double size = 0.2 + 0.8 * unit(random);
        while (uv.size() < 12) {
            const glm::dvec2 at(unit(random), unit(random));
            glm::dvec2 p[3];
            for (glm::dvec2& q : p)
                q = at + size * (glm::dvec2(unit(random), unit(random)) - 0.5);
            if (signedArea(p[0], p[1], p[2]) > 1e-4) uv.insert(uv.end(), p, p + 3);
        }
        double common = 0.0;
        for (size_t i = 0; i < 4; ++i)
            for (size_t k = 0; k < i; ++k)
                common = std::max(common, commonArea(&uv[3 * i], &uv[3 * k]));
        if (common > 0.0 && common < 1e-9) continue; // a touch
        overlapping += common > 0.0;
        ASSERT_EQ(chartOverlaps(uv), common > 0.0) << "round " << round << ", common area " << common;
    }
    EXPECT_GT(overlapping, 300);
    EXPECT_LT(overlapping, 2700);
}

} // namespace
} // namespace relume
