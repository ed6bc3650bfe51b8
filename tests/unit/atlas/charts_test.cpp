#include "assets/atlas/charts.h"

#include "assets/atlas/chart_quality.h"
#include "assets/atlas/uv_grid.h"
#include "assets/base/worker_pool.h"
#include "assets/gltf/gltf.h"
#include "tests/unit/shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace relume {
namespace {

std::vector<glm::dvec3> cornersOf(const Primitive& primitive, double scale = 1.0) {
    std::vector<glm::dvec3> corners;
    for (uint32_t i : primitive.indices)
        corners.push_back(scale * glm::dvec3(primitive.positions[i]));
    return corners;
}

std::vector<PlanarChart> cut(const std::vector<glm::dvec3>& corners, double texel = 0.0) {
    WorkerPool pool(2);
    return cutCharts(corners, texel, pool);
}

Stretch stretchOf(const std::vector<glm::dvec3>& corners, const PlanarChart& chart) {
    std::vector<glm::dvec3> own;
    for (uint32_t t : chart.triangles)
        own.insert(own.end(), {corners[3 * t], corners[3 * t + 1], corners[3 * t + 2]});
    return measureStretch(own, chart.uv);
}

bool hasArea(const glm::dvec3* p) {
    return glm::length(glm::cross(p[1] - p[0], p[2] - p[0])) > 0.0;
}

/// Expects what holds for all charts of any input, and returns their common stretch.
double expectSound(const std::vector<glm::dvec3>& corners, const std::vector<PlanarChart>& charts) {
    Stretch all;
    std::vector<int> times(corners.size() / 3);
    for (const PlanarChart& chart : charts) {
        EXPECT_EQ(chart.uv.size(), 3 * chart.triangles.size());
        for (uint32_t t : chart.triangles)
            ++times[t];
        for (const glm::dvec2& p : chart.uv) {
            EXPECT_GE(std::min(p.x, p.y), -1e-9 * std::max(chart.extent.x, chart.extent.y));
            EXPECT_LE(p.x, chart.extent.x * (1.0 + 1e-9));
            EXPECT_LE(p.y, chart.extent.y * (1.0 + 1e-9));
        }
        const Stretch stretch = stretchOf(corners, chart);
        EXPECT_LE(stretch.normalised(), 1.1501); // infinite where a triangle is turned over
        EXPECT_NEAR(stretch.flat, stretch.surface, 5e-3 * stretch.surface);
        all.add(stretch);
        UvGrid grid(chart.triangles.size() < 64 ? 64 : 256, glm::dvec2(0.0), chart.extent);
        for (size_t i = 0; i < chart.uv.size(); i += 3)
            grid.add(chart.uv[i], chart.uv[i + 1], chart.uv[i + 2]);
        EXPECT_FALSE(grid.overlaps(1e-3)) << "chart of " << chart.triangles.size();
    }
    for (size_t t = 0; t < times.size(); ++t) {
        if (times[t] == 1) continue;
        EXPECT_EQ(times[t], 0);
        EXPECT_FALSE(hasArea(&corners[3 * t])) << "triangle " << t;
    }
    return all.normalised();
}

/// Makes a band of `steps` quads between two circles, open at both ends.
Primitive band(uint32_t steps, float low, float high, float height) {
    std::vector<glm::vec3> positions;
    std::vector<uint32_t> indices;
    for (uint32_t i = 0; i < steps; ++i) {
        const float a = 6.28318531f * float(i) / float(steps);
        positions.push_back({low * std::cos(a), low * std::sin(a), 0.0f});
        positions.push_back({high * std::cos(a), high * std::sin(a), height});
    }
    for (uint32_t i = 0; i < steps; ++i) {
        const uint32_t a = 2 * i, b = 2 * ((i + 1) % steps);
        indices.insert(indices.end(), {a, b, b + 1, a, b + 1, a + 1});
    }
    return test::primitiveOf(positions, indices);
}

TEST(Charts, ACylinderUnrollsToOneStrip) {
    for (uint32_t steps : {8u, 24u, 100u}) {
        const std::vector<glm::dvec3> corners = cornersOf(band(steps, 1.0f, 1.0f, 3.0f));
        const std::vector<PlanarChart> charts = cut(corners);
        ASSERT_EQ(charts.size(), 1u) << steps;
        EXPECT_NEAR(expectSound(corners, charts), 1.0, 1e-5);
        const double around = 2.0 * steps * std::sin(3.14159265 / steps);
        EXPECT_NEAR(std::max(charts[0].extent.x, charts[0].extent.y), std::max(around, 3.0), 1e-2);
        EXPECT_NEAR(std::min(charts[0].extent.x, charts[0].extent.y), std::min(around, 3.0), 1e-2);
    }
}

TEST(Charts, AFrustumUnrollsToOneSector) {
    const std::vector<glm::dvec3> corners = cornersOf(band(48, 2.0f, 1.0f, 1.5f));
    const std::vector<PlanarChart> charts = cut(corners);
    EXPECT_EQ(charts.size(), 1u);
    EXPECT_NEAR(expectSound(corners, charts), 1.0, 1e-3);
}

TEST(Charts, CreasesAreBordersUnlessChartsAreNarrow) {
    const std::vector<glm::dvec3> corners = cornersOf(test::cube());
    EXPECT_EQ(cut(corners).size(), 6u);
    EXPECT_EQ(cut(corners, 0.1).size(), 6u); // ten texels wide
    const std::vector<PlanarChart> joined = cut(corners, 0.5);
    EXPECT_LE(joined.size(), 3u); // parts of the cross of a box that is folded open
    EXPECT_NEAR(expectSound(corners, joined), 1.0, 1e-9);
}

TEST(Charts, TheSidesOfAThinWallAreApart) {
    // A wall of 4 x 3 m has two long edges that are rounded in `steps`.
    for (const int steps : {1, 2, 4, 16}) {
        std::vector<glm::dvec2> outline;
        for (const double side : {1.0, -1.0})
            for (int i = 0; i <= steps; ++i) {
                const double a = 3.14159265358979 * i / steps;
                outline.emplace_back(side * (2.0 + 0.05 * std::sin(a)), side * (-0.05) * std::cos(a));
            }
        std::vector<glm::dvec3> corners;
        for (size_t i = 0; i < outline.size(); ++i) {
            const glm::dvec2 &p = outline[i], &q = outline[(i + 1) % outline.size()];
            const glm::dvec3 a(p.x, p.y, 0), b(q.x, q.y, 0), c(q.x, q.y, 3), d(p.x, p.y, 3);
            corners.insert(corners.end(), {a, b, c, a, c, d});
        }
        const std::vector<PlanarChart> charts = cut(corners, 0.25); // its edges are less than a texel wide
        // An edge that is flat has a chart of its own: light does not pass its creases.
        EXPECT_EQ(charts.size(), steps == 1 ? 4u : 2u) << steps;
        EXPECT_NEAR(expectSound(corners, charts), 1.0, 1e-9);
        for (const PlanarChart& chart : charts) {
            size_t sides = 0; // triangles of the two large sides in this chart
            for (uint32_t t : chart.triangles)
                sides += glm::distance(outline[t / 2], outline[(t / 2 + 1) % outline.size()]) > 3.0;
            if (steps == 1)
                EXPECT_TRUE(sides == 0 || sides == chart.triangles.size()) << sides;
            else
                EXPECT_EQ(sides, 2u) << steps;
        }
    }
}

TEST(Charts, WallsStayAsTheyAre) {
    // A wall of 5 x 3 m with a window in it stands at an angle, with a rounded edge on one side.
    std::vector<glm::dvec3> corners;
    const double c = std::cos(0.4), s = std::sin(0.4);
    const auto quad = [&](glm::dvec3 a, glm::dvec3 b, glm::dvec3 d, glm::dvec3 e) {
        for (glm::dvec3 p : {a, b, d, a, d, e})
            corners.emplace_back(c * p.x - s * p.y, s * p.x + c * p.y, p.z);
    };
    const double x[] = {0, 2, 3, 5}, z[] = {0, 1, 2, 3};
    for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k)
            if (i != 1 || k != 1)
                quad({x[i], 0, z[k]}, {x[i + 1], 0, z[k]}, {x[i + 1], 0, z[k + 1]}, {x[i], 0, z[k + 1]});
    const auto rounded = [](int i, double height) {
        const double a = 0.19634954 * i; // 8 steps to 90 degrees
        return glm::dvec3(5.0 + 0.1 * std::sin(a), 0.1 - 0.1 * std::cos(a), height);
    };
    for (int i = 0; i < 8; ++i)
        for (int k = 0; k < 3; ++k)
            quad(rounded(i, z[k]), rounded(i + 1, z[k]), rounded(i + 1, z[k + 1]), rounded(i, z[k + 1]));
    const std::vector<PlanarChart> charts = cut(corners);
    EXPECT_NEAR(expectSound(corners, charts), 1.0, 1e-6);
    EXPECT_LE(charts.size(), 2u);
    for (const PlanarChart& chart : charts) {
        for (size_t i = 0; i < chart.triangles.size(); ++i) {
            if (chart.triangles[i] >= 16) continue;
            double low = 1e9, high = -1e9;
            for (size_t k = 0; k < 3; ++k) { // each triangle of the wall has a side along each axis
                low = std::min(low, std::abs(chart.uv[3 * i + k].x - chart.uv[3 * i + (k + 1) % 3].x));
                high = std::max(high, std::abs(chart.uv[3 * i + k].x - chart.uv[3 * i + (k + 1) % 3].x));
            }
            EXPECT_NEAR(low, 0.0, 1e-9);
            EXPECT_GE(high, 1.0 - 1e-9);
        }
    }
}

TEST(Charts, BothSidesOfADoubledWallHoldTogether) {
    std::vector<glm::dvec3> corners;
    for (int i = 0; i < 4; ++i)
        for (int k = 0; k < 4; ++k)
            for (bool back : {false, true}) {
                const glm::dvec3 a(i, k, 0), b(i + 1, k, 0), c(i + 1, k + 1, 0), d(i, k + 1, 0);
                if (back)
                    corners.insert(corners.end(), {a, c, b, a, d, c});
                else
                    corners.insert(corners.end(), {a, b, c, a, c, d});
            }
    const std::vector<PlanarChart> charts = cut(corners);
    EXPECT_EQ(charts.size(), 2u);
    expectSound(corners, charts);
}

TEST(Charts, AWallThatIsThereTwiceCoversNothingTwice) {
    std::vector<glm::dvec3> corners;
    for (int times = 0; times < 2; ++times)
        for (int i = 0; i < 5; ++i)
            for (int k = 0; k < 5; ++k) {
                const glm::dvec3 a(i, k, 0), b(i + 1, k, 0), c(i + 1, k + 1, 0), d(i, k + 1, 0);
                corners.insert(corners.end(), {a, b, c, a, c, d});
            }
    const std::vector<PlanarChart> charts = cut(corners);
    EXPECT_LE(charts.size(), 10u);
    expectSound(corners, charts);
}

TEST(Charts, CurvedSurfacesNeedFew) {
    const std::vector<glm::dvec3> sphere = cornersOf(test::sphere(48)),
                                  knot = cornersOf(test::torusKnot(200, 16));
    const std::vector<PlanarChart> ofSphere = cut(sphere), ofKnot = cut(knot);
    expectSound(sphere, ofSphere);
    expectSound(knot, ofKnot);
    EXPECT_LE(ofSphere.size(), 6u);
    EXPECT_LE(ofKnot.size(), 40u);
}

TEST(Charts, AnySoup) {
    for (const auto& [triangles, vertices, seed] :
         {std::array{2000u, 6000u, 1u}, std::array{2000u, 300u, 2u}, std::array{500u, 12u, 3u}}) {
        const std::vector<glm::dvec3> corners = cornersOf(test::soup(triangles, vertices, seed));
        expectSound(corners, cut(corners));
        expectSound(corners, cut(corners, 0.2));
    }
}

TEST(Charts, AnyScale) {
    const Primitive knot = test::torusKnot(60, 12);
    const size_t expected = cut(cornersOf(knot)).size();
    for (double scale : {1e-12, 1e-3, 1e8}) {
        const std::vector<glm::dvec3> corners = cornersOf(knot, scale);
        const std::vector<PlanarChart> charts = cut(corners);
        EXPECT_NEAR(double(charts.size()), double(expected), 2.0) << scale;
        expectSound(corners, charts);
    }
}

TEST(Charts, DegenerateInput) {
    EXPECT_TRUE(cut({}).empty());
    const double nan = std::numeric_limits<double>::quiet_NaN(),
                 inf = std::numeric_limits<double>::infinity();
    EXPECT_TRUE(cut({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}).empty());
    EXPECT_TRUE(cut({{5, 5, 5}, {5, 5, 5}, {5, 5, 5}}).empty());
    std::vector<glm::dvec3> corners = {{0, 0, 0},   {1, 0, 0}, {0, 1, 0}, {nan, 0, 0}, {1, 0, 0}, {0, 1, 0},
                                       {inf, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0},   {1, 0, 0}, {1, 0, 0}};
    const std::vector<PlanarChart> charts = cut(corners);
    ASSERT_EQ(charts.size(), 1u);
    EXPECT_EQ(charts[0].triangles, std::vector<uint32_t>{0});
    // Slivers around one corner, each a thousandth as wide as long and in a plane of its own.
    corners.clear();
    for (int i = 0; i < 500; ++i) {
        const double a = 1e-3 * i, b = 1e-3 * (i + 1);
        corners.insert(corners.end(), {{0, 0, 0},
                                       {std::cos(a), std::sin(a), i % 2 ? 3e-4 : 0.0},
                                       {std::cos(b), std::sin(b), i % 2 ? 0.0 : 3e-4}});
    }
    expectSound(corners, cut(corners));
}

void expectSame(const std::vector<PlanarChart>& a, const std::vector<PlanarChart>& b) {
    ASSERT_EQ(a.size(), b.size());
    for (size_t i = 0; i < a.size(); ++i) {
        ASSERT_EQ(a[i].triangles, b[i].triangles);
        ASSERT_EQ(a[i].uv, b[i].uv);
        ASSERT_EQ(a[i].extent, b[i].extent);
    }
}

TEST(Charts, SameOnAnyNumberOfThreads) {
    for (const Primitive& primitive : {test::torusKnot(200, 16), test::soup(2000, 300, 5)}) {
        const std::vector<glm::dvec3> corners = cornersOf(primitive);
        WorkerPool one(1), two(2), five(5);
        const std::vector<PlanarChart> charts = cutCharts(corners, 0.01, one);
        expectSame(charts, cutCharts(corners, 0.01, two));
        expectSame(charts, cutCharts(corners, 0.01, five));
        expectSame(charts, cutCharts(corners, 0.01, five));
    }
}

/// Cuts the meshes of a scene that ships, each as it is in the file, and returns the number of charts.
size_t expectSoundScene(const std::string& name) {
    SCOPED_TRACE(name);
    const Scene scene = loadGltf(std::string(RELUME_SOURCE_DIR) + "/assets/scenes/" + name + ".glb");
    size_t count = 0;
    for (const Mesh& mesh : scene.meshes) {
        SCOPED_TRACE(mesh.name);
        std::vector<glm::dvec3> corners;
        for (const Primitive& primitive : mesh.primitives) {
            const std::vector<glm::dvec3> own = cornersOf(primitive);
            corners.insert(corners.end(), own.begin(), own.end());
        }
        const std::vector<PlanarChart> charts = cut(corners);
        expectSound(corners, charts);
        count += charts.size();
    }
    return count;
}

// Others need 393 charts for the statue's scene and 3,701 for the atrium's (xatlas with its defaults).
TEST(Charts, ShippedScenesNeedFew) {
    EXPECT_LE(expectSoundScene("cornell_statue"), 100u);
    EXPECT_LE(expectSoundScene("atrium"), 2100u);
    EXPECT_LE(expectSoundScene("gallery"), 450u);
    EXPECT_LE(expectSoundScene("octagon"), 280u);
    EXPECT_EQ(expectSoundScene("cornell_small"), 17u);
}

} // namespace
} // namespace relume
