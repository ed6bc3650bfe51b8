#include "bake/links/directions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

namespace relume {
namespace {

// Returns the distance of the two nearest of the first n points.
double leastDistance(const std::vector<glm::dvec2>& points, size_t n) {
    double least = 4;
    for (size_t i = 0; i < n; ++i)
        for (size_t j = 0; j < i; ++j)
            least = std::min(least, glm::length(points[i] - points[j]));
    return least;
}

// Finds the largest empty circle by brute force over a fine grid, with borders as in the header.
double largestCircle(const std::vector<glm::dvec2>& points, size_t n, int grid) {
    double largest = 0;
    for (int i = 0; i < grid * grid; ++i) {
        const glm::dvec2 p = 2.0 * (glm::dvec2(i % grid, i / grid) + 0.5) / double(grid) - 1.0;
        double radius = 2 * (1 - glm::length(p));
        for (size_t k = 0; k < n && radius > largest; ++k)
            radius = std::min(radius, glm::length(p - points[k]));
        largest = std::max(largest, radius);
    }
    return largest;
}

} // namespace

TEST(Directions, EachPointFillsTheLargestEmptyCircle) {
    const std::vector<glm::dvec2> points = largestEmptyCircleDisc(300);
    double before = 2;
    for (size_t n = 1; n < 300; ++n) {
        double radius = 2 * (1 - glm::length(points[n]));
        for (size_t k = 0; k < n; ++k)
            radius = std::min(radius, glm::length(points[n] - points[k]));
        EXPECT_LE(radius, before + 1e-9) << n; // circles only get smaller
        before = radius;
        if (n == 1 || n % 23 == 0) {
            EXPECT_GE(radius, largestCircle(points, n, 200) - 1e-9) << n;
        }
    }
}

// An even set of n points of the unit disc is at best a hexagonal one, of distance sqrt(2 pi / (sqrt 3 n)).
TEST(Directions, PointsKeepApart) {
    const std::vector<glm::dvec2> points = largestEmptyCircleDisc(1024);
    double before = 2;
    for (const size_t n : {2u, 7u, 16u, 61u, 128u, 400u, 1024u}) {
        const double least = leastDistance(points, n);
        EXPECT_LE(least, before);
        before = least;
        const double hexagonal = std::sqrt(2 * std::numbers::pi / (std::sqrt(3.0) * double(n)));
        EXPECT_LT(least, 1.5 * hexagonal) << n;
        if (n > 2) {
            EXPECT_GT(least, 0.6 * hexagonal) << n;
        }
    }
    for (const glm::dvec2& p : points)
        EXPECT_LT(glm::length(p), 1);
}

TEST(Directions, SmallerSetsAreBeginningsOfLargerOnes) {
    const std::vector<glm::dvec2> all = largestEmptyCircleDisc(1024);
    for (const uint32_t n : {1u, 2u, 3u, 4u, 100u, 1023u}) {
        const std::vector<glm::dvec2> some = largestEmptyCircleDisc(n);
        ASSERT_EQ(some.size(), n);
        for (uint32_t i = 0; i < n; ++i)
            EXPECT_EQ(some[i], all[i]);
    }
    EXPECT_TRUE(largestEmptyCircleDisc(0).empty());
}

// With density cos / pi, the mean of the cosine is 2/3, of its square 1/2, of x^2 1/4.
TEST(Directions, EvenedSetsHaveTheCosinesMoments) {
    for (const uint32_t n : {1u, 4u, 16u, 64u, 256u, 777u, 1024u}) {
        const std::vector<glm::dvec2> points = evenRings(largestEmptyCircleDisc(n));
        double z = 0, z2 = 0, x = 0, y = 0, x2 = 0;
        for (const glm::dvec2& p : points) {
            const glm::dvec3 d = projectedUp(p);
            EXPECT_NEAR(glm::length(d), 1, 1e-12);
            EXPECT_GT(d.z, 0);
            z += d.z / n, z2 += d.z * d.z / n, x += d.x / n, y += d.y / n, x2 += d.x * d.x / n;
        }
        EXPECT_NEAR(z, 2.0 / 3, 0.05 / n) << n; // rings of equal area, their middles
        EXPECT_NEAR(z2, 0.5, 1e-9) << n;
        if (n < 16) continue;
        EXPECT_NEAR(x, 0, 0.3 / std::sqrt(double(n))) << n;
        EXPECT_NEAR(y, 0, 0.3 / std::sqrt(double(n))) << n;
        EXPECT_NEAR(x2, 0.25, 0.3 / std::sqrt(double(n))) << n;
    }
}

// Each ring holds one point, in the order of distance that the points had.
TEST(Directions, EveningKeepsDirectionAndOrder) {
    const std::vector<glm::dvec2> points = largestEmptyCircleDisc(500), even = evenRings(points);
    std::vector<double> rings;
    for (size_t i = 0; i < points.size(); ++i) {
        rings.push_back(glm::dot(even[i], even[i]) * 500);
        EXPECT_NEAR(points[i].x * even[i].y, points[i].y * even[i].x, 1e-9);
        EXPECT_LT(glm::length(points[i] - even[i]), 0.1); // hardly moved
    }
    std::sort(rings.begin(), rings.end());
    for (size_t i = 0; i < rings.size(); ++i)
        EXPECT_NEAR(rings[i], double(i) + 0.5, 1e-6);
}

TEST(Directions, FourThousandAreMadeInMoments) {
    const auto start = std::chrono::steady_clock::now();
    EXPECT_EQ(largestEmptyCircleDisc(4096).size(), 4096u);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    EXPECT_LT(seconds.count(), 10);
    EXPECT_EQ(largestEmptyCircleDisc(kMostDirections).size(), kMostDirections);
}

} // namespace relume
