#include "assets/atlas/chart_layout.h"

#include "assets/atlas/mask_atlas.h"
#include "assets/base/error.h"
#include "tests/message_of.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

namespace relume {
namespace {

// What reaches less far into a texel than this does not touch it: that is what a mask allows, and the
// rounding of floats.
constexpr double kSlack = 0.01; // [texels]

/// Tells by separating axes whether a triangle meets the texel at (x, y), larger by `growth` to each side
/// [Akenine-Moeller 2001].
bool touches(const glm::dvec2* p, int x, int y, double growth = 0.0) {
    const glm::dvec2 centre(x + 0.5, y + 0.5);
    const double half = 0.5 + growth - kSlack;
    for (int c = 0; c < 2; ++c)
        if (std::max({p[0][c], p[1][c], p[2][c]}) <= centre[c] - half ||
            std::min({p[0][c], p[1][c], p[2][c]}) >= centre[c] + half)
            return false;
    for (int e = 0; e < 3; ++e) {
        const glm::dvec2 edge = p[(e + 1) % 3] - p[e];
        glm::dvec2 normal(-edge.y, edge.x);
        if (glm::dot(normal, p[(e + 2) % 3] - p[e]) < 0.0) normal = -normal;
        if (glm::dot(normal, centre - p[e]) + half * (std::abs(normal.x) + std::abs(normal.y)) <= 0.0)
            return false;
    }
    return true;
}

PlanarChart rectangle(double width, double height) {
    PlanarChart chart;
    chart.triangles = {0, 1};
    chart.uv = {{0, 0}, {width, 0}, {width, height}, {0, 0}, {width, height}, {0, height}};
    chart.extent = {width, height};
    return chart;
}

PlanarChart corner(double width, double height) { // a right triangle
    PlanarChart chart = rectangle(width, height);
    chart.triangles = {0};
    chart.uv.resize(3);
    return chart;
}

/// Makes an L of two arms, an eighth as wide as long.
PlanarChart angle(double side) {
    PlanarChart chart;
    chart.triangles = {0, 1, 2, 3};
    const double w = side / 8.0;
    chart.uv = {{0, 0}, {side, 0}, {side, w}, {0, 0}, {side, w}, {0, w},
                {0, w}, {w, w},    {w, side}, {0, w}, {w, side}, {0, side}};
    chart.extent = {side, side};
    return chart;
}

std::vector<PlanarChart> randomCharts(size_t count, uint32_t seed, double least, double most) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> exponent(std::log(least), std::log(most));
    std::vector<PlanarChart> charts;
    for (size_t i = 0; i < count; ++i) {
        const double width = std::exp(exponent(random)), height = std::exp(exponent(random));
        charts.push_back(i % 3 == 0   ? rectangle(width, height)
                         : i % 3 == 1 ? corner(width, height)
                                      : angle(width));
    }
    return charts;
}

std::vector<LayoutChart> layoutOf(const std::vector<PlanarChart>& charts) {
    std::vector<LayoutChart> result;
    for (const PlanarChart& chart : charts)
        result.push_back({&chart, 1.0});
    return result;
}

/// Expects that no texel is touched twice, that all lie in the atlas, and that gutters are as promised;
/// returns the share of the atlas that is touched.
double expectSound(const std::vector<PlanarChart>& charts, const ChartLayout& layout, int size) {
    EXPECT_EQ(layout.places.size(), charts.size());
    std::vector<int> owner(static_cast<size_t>(size) * size, -1);
    std::vector<int> reader(owner.size(), -1); // the chart for which bilinear filters read a texel
    uint64_t touched = 0, readTwice = 0;
    for (size_t i = 0; i < charts.size(); ++i) {
        const ChartPlace& place = layout.places[i];
        const glm::dvec2 sides = charts[i].extent * place.stretch;
        const bool thin = std::min(sides.x, sides.y) < 0.5;
        for (size_t t = 0; t < charts[i].uv.size(); t += 3) {
            const glm::dvec2 p[3] = {place.texelOf(charts[i].uv[t]), place.texelOf(charts[i].uv[t + 1]),
                                     place.texelOf(charts[i].uv[t + 2])};
            const glm::dvec2 low = glm::min(p[0], glm::min(p[1], p[2]));
            const glm::dvec2 high = glm::max(p[0], glm::max(p[1], p[2]));
            EXPECT_GE(std::min(low.x, low.y), -1e-9);
            EXPECT_LE(std::max(high.x, high.y), size + 1e-9);
            for (int y = std::max(int(low.y) - 1, 0); y < std::min(int(high.y) + 2, size); ++y)
                for (int x = std::max(int(low.x) - 1, 0); x < std::min(int(high.x) + 2, size); ++x) {
                    if (!thin && touches(p, x, y, 0.5)) {
                        int& read = reader[static_cast<size_t>(y) * size + x];
                        readTwice += read >= 0 && read != int(i);
                        read = int(i);
                    }
                    if (!touches(p, x, y)) continue;
                    int& own = owner[static_cast<size_t>(y) * size + x];
                    touched += own < 0;
                    EXPECT_TRUE(own < 0 || own == int(i)) << "texel " << x << ", " << y;
                    own = int(i);
                }
        }
    }
    EXPECT_EQ(readTwice, 0u);
    EXPECT_NEAR(double(touched), double(layout.touched), 0.002 * double(touched));
    return static_cast<double>(touched) / (double(size) * size);
}

TEST(TexelMask, TouchedTexelsAreThoseOfSeparatingAxes) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> unit(0.0, 70.0);
    for (int i = 0; i < 200; ++i) {
        glm::dvec2 p[3] = {
            {unit(random), unit(random)}, {unit(random), unit(random)}, {unit(random), unit(random)}};
        if (i % 4 == 0) p[2] = p[0] + 0.3 * (p[2] - p[0]) / 70.0; // small and thin ones, too
        TexelMask mask(70, 70);
        mask.addTouched(p[0], p[1], p[2]);
        uint64_t missing = 0, added = 0;
        for (int y = 0; y < 70; ++y)
            for (int x = 0; x < 70; ++x) {
                const bool has = mask.has(uint32_t(x), uint32_t(y));
                missing += touches(p, x, y) && !has;
                // What reaches in less far than the slack may be there or not.
                glm::dvec2 wider[3];
                const glm::dvec2 middle = (p[0] + p[1] + p[2]) / 3.0;
                for (int k = 0; k < 3; ++k)
                    wider[k] = p[k] + 4.0 * kSlack * glm::normalize(p[k] - middle);
                added += has && !touches(wider, x, y) && !touches(p, x, y);
            }
        EXPECT_EQ(missing, 0u) << i;
        EXPECT_LE(added, 4u) << i;
    }
}

TEST(TexelMask, FourQuarterTurnsAreNone) {
    TexelMask mask(130, 67);
    mask.addTouched({0, 0}, {130, 3}, {20, 67});
    const TexelMask quarter = mask.turned();
    EXPECT_EQ(quarter.width(), 67u);
    EXPECT_EQ(quarter.height(), 130u);
    const TexelMask whole = quarter.turned().turned().turned();
    for (uint32_t y = 0; y < 67; ++y)
        for (uint32_t x = 0; x < 130; ++x) {
            EXPECT_EQ(mask.has(x, y), whole.has(x, y));
            EXPECT_EQ(mask.has(x, y), quarter.has(66 - y, x));
        }
    EXPECT_EQ(mask.count(), quarter.count());
    uint64_t inRuns = 0;
    for (const TexelRun& run : mask.runs())
        inRuns += run.end - run.begin;
    EXPECT_EQ(inRuns, mask.count());
}

TEST(MaskAtlas, FindsTheLowestPlaceThatTryingAllFinds) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> side(1.0, 40.0);
    constexpr uint32_t kWide = 150, kHigh = 200;
    MaskAtlas atlas(kWide, kHigh);
    std::vector<uint8_t> taken(size_t{kWide} * kHigh);
    for (int i = 0; i < 60; ++i) {
        TexelMask mask(uint32_t(side(random)), uint32_t(side(random)));
        mask.addTouched({0, 0}, {mask.width(), 0.3 * mask.height()}, {0.6 * mask.width(), mask.height()});
        const auto isFree = [&](uint32_t x, uint32_t y) {
            for (const TexelRun& run : mask.runs())
                for (uint32_t c = run.begin; c < run.end; ++c)
                    if (taken[size_t(y + run.row) * kWide + x + c]) return false;
            return true;
        };
        std::optional<glm::uvec2> expected;
        for (uint32_t y = 0; y + mask.height() <= kHigh && !expected; ++y)
            for (uint32_t x = 0; x + mask.width() <= kWide && !expected; ++x)
                if (isFree(x, y)) expected = glm::uvec2(x, y);
        const MaskShape shape(mask);
        const std::optional<glm::uvec2> found = atlas.lowestPlace(shape, 0, kHigh);
        ASSERT_EQ(found, expected) << i;
        if (!found) continue;
        EXPECT_TRUE(atlas.isFree(shape, *found));
        atlas.add(shape, *found);
        EXPECT_FALSE(atlas.isFree(shape, *found));
        for (const TexelRun& run : mask.runs())
            for (uint32_t c = run.begin; c < run.end; ++c)
                taken[size_t(found->y + run.row) * kWide + found->x + c] = 1;
    }
    EXPECT_FALSE(atlas.lowestPlace(MaskShape(TexelMask(151, 1)), 0, kHigh));
}

TEST(ChartLayout, RandomChartsAreSoundAtSeveralSizes) {
    WorkerPool pool(0);
    for (const int size : {16, 63, 64, 200, 400}) {
        SCOPED_TRACE(size);
        const std::vector<PlanarChart> charts = randomCharts(size < 64 ? 20 : 300, uint32_t(size), 0.02, 3.0);
        const ChartLayout layout = layOutCharts(layoutOf(charts), {uint32_t(size)}, pool);
        const double covered = expectSound(charts, layout, size);
        EXPECT_GT(covered, size < 200 ? 0.3 : size < 400 ? 0.55 : 0.75);
        EXPECT_LE(layout.reserved,
                  static_cast<uint64_t>(size + 2) * (size + 2)); // gutters may leave the atlas
    }
}

TEST(ChartLayout, RectanglesLieOnWholeTexels) {
    WorkerPool pool(1);
    const std::vector<PlanarChart> charts = {rectangle(4, 3), rectangle(4, 2.5), rectangle(3, 2.5),
                                             rectangle(1, 0.7)};
    const ChartLayout layout = layOutCharts(layoutOf(charts), {256}, pool);
    expectSound(charts, layout, 256);
    for (size_t i = 0; i < charts.size(); ++i) {
        for (const glm::dvec2& uv : charts[i].uv) {
            const glm::dvec2 p = layout.places[i].texelOf(uv);
            EXPECT_NEAR(p.x, std::round(p.x), 1e-9);
            EXPECT_NEAR(p.y, std::round(p.y), 1e-9);
        }
        // One density, but for the rounding and for texels that are not quite square.
        for (int c = 0; c < 2; ++c)
            EXPECT_NEAR(layout.places[i].stretch[c] / layout.density, 1.0,
                        0.025 + 0.5 / layout.places[i].box[c]);
    }
}

TEST(ChartLayout, SmallChartsLieSideBySide) {
    WorkerPool pool(1);
    // 8 x 8 squares of 4 texels and one more, not of two, fill 40 x 40.
    const std::vector<PlanarChart> charts(64, rectangle(1, 1));
    const ChartLayout layout = layOutCharts(layoutOf(charts), {40}, pool);
    EXPECT_EQ(expectSound(charts, layout, 40), 1.0);
    EXPECT_EQ(layout.reserved, layout.touched);
    for (const ChartPlace& place : layout.places) {
        EXPECT_EQ(place.box, glm::uvec2(5));
        const glm::dvec2 a = place.texelOf({0, 0}), b = place.texelOf({1, 1});
        const glm::dvec2 low = glm::min(a, b) - glm::dvec2(place.corner);
        const glm::dvec2 high = glm::max(a, b) - glm::dvec2(place.corner);
        for (int c = 0; c < 2;
             ++c) { // it covers the centres of its outermost texels, by no more than filters tell
            EXPECT_LT(low[c], 0.5);
            EXPECT_GE(low[c], 0.5 - 1.0 / 256.0 - 1e-9);
            EXPECT_GT(high[c], 4.5);
            EXPECT_LE(high[c], 4.5 + 1.0 / 256.0 + 1e-9);
        }
    }
}

TEST(ChartLayout, NarrowStripsCoverTheCentresOfTheirTexels) {
    WorkerPool pool(1);
    std::vector<PlanarChart> charts;
    for (int i = 0; i < 40; ++i)
        charts.push_back(rectangle(0.02 + 0.02 * i, 20.0)); // from far below a texel to a few
    const ChartLayout layout = layOutCharts(layoutOf(charts), {128}, pool);
    expectSound(charts, layout, 128);
    for (size_t i = 0; i < charts.size(); ++i) {
        const ChartPlace& place = layout.places[i];
        const glm::dvec2 a = place.texelOf({0, 0}), b = place.texelOf(charts[i].extent);
        for (int c = 0; c < 2; ++c) {
            const double low = std::min(a[c], b[c]), high = std::max(a[c], b[c]);
            EXPECT_LT(std::floor(low) + 0.5, high) << i;
            EXPECT_GT(std::floor(low) + 0.5, low) << i;
        }
    }
}

TEST(ChartLayout, AGivenDensityIsKeptWhereItFits) {
    WorkerPool pool(0);
    const std::vector<PlanarChart> charts = randomCharts(100, 5, 0.1, 2.0);
    const std::vector<LayoutChart> list = layoutOf(charts);
    const ChartLayout most = layOutCharts(list, {256}, pool);
    const ChartLayout half = layOutCharts(list, {256, 0.5 * most.density}, pool);
    EXPECT_EQ(half.density, 0.5 * most.density);
    EXPECT_EQ(half.aspect, 1.0);
    const ChartLayout beyond = layOutCharts(list, {256, 2.0 * most.density}, pool);
    EXPECT_NEAR(beyond.density, most.density, 0.02 * most.density);
    const std::optional<uint32_t> size = sizeForCharts(list, half.density, 1024);
    ASSERT_TRUE(size);
    EXPECT_GT(*size, 100u);
    EXPECT_LT(*size, 150u);
    EXPECT_EQ(layOutCharts(list, {*size, half.density}, pool).density, half.density);
    EXPECT_FALSE(sizeForCharts(list, 100.0 * half.density, 1024));
}

TEST(ChartLayout, TheSameOnAnyNumberOfThreads) {
    const std::vector<PlanarChart> charts = randomCharts(120, 3, 0.05, 2.0);
    const std::vector<LayoutChart> list = layoutOf(charts);
    WorkerPool one(1), two(2), five(5);
    const ChartLayout layout = layOutCharts(list, {256}, one);
    EXPECT_EQ(layOutCharts(list, {256}, two).places, layout.places);
    EXPECT_EQ(layOutCharts(list, {256}, five).places, layout.places);
    EXPECT_EQ(layOutCharts(list, {256}, one).places, layout.places);
}

TEST(ChartLayout, AChartLongerThanTheAtlas) {
    WorkerPool pool(1);
    // A wire is shortened, because nobody sees it; all others keep their density.
    std::vector<PlanarChart> charts = {rectangle(1e6, 1e-3), rectangle(1, 1), rectangle(1, 2)};
    const ChartLayout wire = layOutCharts(layoutOf(charts), {128}, pool);
    expectSound(charts, wire, 128);
    EXPECT_GT(wire.density, 30.0);
    EXPECT_EQ(std::max(wire.places[0].box.x, wire.places[0].box.y), 128u);
    EXPECT_EQ(wire.shortened, 1u);
    EXPECT_NEAR(wire.leastShare * wire.density, 128 / 1e6, 0.03 * 128 / 1e6);
    // A road lowers the density, but not until it fits as it is: it is shortened where it is but 8 texels
    // wide.
    charts[0] = rectangle(1e4, 8);
    const ChartLayout road = layOutCharts(layoutOf(charts), {128}, pool);
    expectSound(charts, road, 128);
    EXPECT_NEAR(road.density, 1.0, 0.15);
    EXPECT_EQ(road.shortened, 1u);
    EXPECT_NEAR(road.leastShare * road.density, 128 / 1e4, 0.03 * 128 / 1e4);
    // A plain is shortened by 15 % at most.
    charts[0] = rectangle(1e4, 5e3);
    const ChartLayout plain = layOutCharts(layoutOf(charts), {128}, pool);
    expectSound(charts, plain, 128);
    EXPECT_GE(plain.density, 0.99 * 128 / 1e4);
    EXPECT_LE(plain.density, 1.16 * 128 / 1e4);
    EXPECT_GE(plain.leastShare, 1 / 1.16);
    // A chart that fits is not shortened.
    charts[0] = rectangle(1, 1);
    const ChartLayout squares = layOutCharts(layoutOf(charts), {128}, pool);
    EXPECT_EQ(squares.shortened, 0u);
    EXPECT_EQ(squares.leastShare, 1.0);
}

TEST(ChartLayout, NoChartsAndTooMany) {
    WorkerPool pool(0);
    EXPECT_TRUE(layOutCharts({}, {64}, pool).places.empty());
    const std::vector<PlanarChart> charts = {rectangle(1, 1)};
    std::vector<LayoutChart> list(32 * 32, {charts.data(), 1.0});
    // One texel for each chart is always possible, and no less.
    const ChartLayout full = layOutCharts(list, {32}, pool);
    EXPECT_EQ(full.touched, 32u * 32u);
    list.push_back(list.front());
    EXPECT_EQ(messageOf([&] { layOutCharts(list, {32}, pool); }),
              "1025 charts do not fit a lightmap of 32 x 32 texels: --size 64 fits");
    EXPECT_NO_THROW(layOutCharts(list, {64}, pool));
}

TEST(ChartLayout, AHundredThousandCharts) {
    WorkerPool pool(0);
    const std::vector<PlanarChart> charts = randomCharts(1000, 9, 0.01, 0.1);
    std::vector<LayoutChart> list;
    for (int i = 0; i < 100; ++i)
        for (const PlanarChart& chart : charts)
            list.push_back({&chart, 1.0});
    // A density that fits is tried but twice.
    const ChartLayout layout = layOutCharts(list, {1024, 20.0}, pool);
    EXPECT_EQ(layout.places.size(), list.size());
    EXPECT_EQ(layout.density, 20.0);
    EXPECT_GT(layout.reserved, 1024u * 1024u / 4u);
}

TEST(ChartLayout, ExtendingKeepsPlaces) {
    WorkerPool pool(0);
    std::vector<PlanarChart> charts = randomCharts(60, 11, 0.1, 2.0);
    const ChartLayout first = layOutCharts(layoutOf(charts), {256, 10.0}, pool);
    std::vector<std::optional<ChartPlace>> places(first.places.begin(), first.places.end());
    charts.push_back(rectangle(1.5, 1.5));
    places.emplace_back();
    const std::vector<LayoutChart> list = layoutOf(charts);
    const std::optional<ChartLayout> more = extendLayout(list, {256, 10.0}, first, places);
    ASSERT_TRUE(more);
    EXPECT_TRUE(std::equal(first.places.begin(), first.places.end(), more->places.begin()));
    expectSound(charts, *more, 256);
    places.back() = first.places.front(); // taken
    places.back()->box = glm::uvec2(15);
    EXPECT_FALSE(extendLayout(list, {256, 10.0}, first, places));
    places.back().reset();
    charts.back() = rectangle(25, 25); // larger than what is left
    EXPECT_FALSE(extendLayout(layoutOf(charts), {256, 10.0}, first, places));
}

} // namespace
} // namespace relume
