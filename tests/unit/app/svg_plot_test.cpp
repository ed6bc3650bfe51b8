#include "app/text/svg_plot.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/unit/markup.h"

namespace relume {
namespace {

size_t countOf(const std::string& text, const std::string& part) {
    size_t count = 0;
    for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
        ++count;
    return count;
}

TEST(SvgPlot, DrawsALineAndItsPoints) {
    const std::string svg =
        logLogPlot({.title = "t",
                    .xLabel = "x",
                    .yLabel = "y",
                    .series = {{.name = "a", .points = {{1, 1}, {10, 100}, {100, 10000}}}}});
    EXPECT_EQ(markupProblem(svg), "");
    EXPECT_EQ(countOf(svg, "<circle"), 3u);
    // Steps are equal on logarithmic axes: the middle point is half-way.
    double x[3] = {}, y[3] = {};
    size_t at = 0;
    for (int i = 0; i < 3; ++i) {
        at = svg.find("<circle", at + 1);
        ASSERT_EQ(std::sscanf(svg.c_str() + at, "<circle cx=\"%lf\" cy=\"%lf\"", &x[i], &y[i]), 2);
    }
    EXPECT_NEAR(x[1], (x[0] + x[2]) / 2, 0.11);
    EXPECT_NEAR(y[1], (y[0] + y[2]) / 2, 0.11);
    EXPECT_GT(x[2], x[0]);
    EXPECT_LT(y[2], y[0]); // upwards
}

TEST(SvgPlot, LeavesOutWhatHasNoLogarithm) {
    const double inf = std::numeric_limits<double>::infinity();
    const std::string svg =
        logLogPlot({.title = "t",
                    .xLabel = "x",
                    .yLabel = "y",
                    .series = {{.name = "a",
                                .points = {{0, 1}, {1, 0}, {-1, 1}, {inf, 1}, {1, std::nan("")}, {2, 3}}}}});
    EXPECT_EQ(markupProblem(svg), "");
    EXPECT_EQ(countOf(svg, "<circle"), 1u);
    EXPECT_EQ(svg.find("nan"), std::string::npos);
    EXPECT_EQ(svg.find("inf"), std::string::npos);
}

TEST(SvgPlot, AFileOfItsOwnHasALegend) {
    const PlotDesc desc{.title = "a < b",
                        .xLabel = "x",
                        .yLabel = "y",
                        .series = {{.name = "first & last", .points = {{1, 1}, {10, 2}}}, {.name = "other"}}};
    const std::string svg = logLogPlotFile(desc);
    EXPECT_EQ(markupProblem(svg), "");
    EXPECT_EQ(svg.find("<svg xmlns=\"http://www.w3.org/2000/svg\""), 0u);
    EXPECT_EQ(countOf(svg, "<svg"), 1u);
    EXPECT_EQ(countOf(svg, "<circle"), 2u);
    EXPECT_EQ(countOf(svg, ">first &amp; last</text>"), 1u);
    EXPECT_EQ(countOf(svg, ">other</text>"), 1u);
    EXPECT_EQ(countOf(svg, ">a &lt; b</text>"), 1u);
}

TEST(SvgPlot, SaysWhenThereIsNothing) {
    for (const std::vector<PlotSeries>& none :
         {std::vector<PlotSeries>{}, std::vector<PlotSeries>{{.name = "a", .points = {{0, 0}}}}}) {
        const std::string svg = logLogPlot({.title = "t", .xLabel = "x", .yLabel = "y", .series = none});
        EXPECT_EQ(markupProblem(svg), "");
        EXPECT_NE(svg.find("nothing was measured"), std::string::npos);
    }
}

TEST(SvgPlot, KeepsMarkersOfFarValuesOnThePage) {
    const std::string svg = logLogPlot({.title = "t",
                                        .xLabel = "x",
                                        .yLabel = "y",
                                        .series = {{.name = "a", .points = {{1e-9, 1e12}, {1e9, 1e-12}}}}});
    EXPECT_EQ(markupProblem(svg), "");
    EXPECT_LT(countOf(svg, "<text"), 40u); // 18 and 24 decades
}

TEST(SvgPlot, EscapesText) {
    EXPECT_EQ(escapeMarkup("a<b>&\"c\"'"), "a&lt;b&gt;&amp;&quot;c&quot;&#39;");
    EXPECT_EQ(escapeMarkup("Grün ²"), "Grün ²");
    EXPECT_EQ(escapeMarkup("\xff"
                           "a\x01\xc3"),
              "\xef\xbf\xbd"
              "a\xef\xbf\xbd\xef\xbf\xbd");
    EXPECT_EQ(escapeMarkup("\xed\xa0\x80").find('\xed'), std::string::npos); // a surrogate
    const std::string svg = logLogPlot({.title = "<t>",
                                        .xLabel = "x & y",
                                        .yLabel = "\"y\"",
                                        .series = {{.name = "</svg>", .points = {{1, 1, "<i>", "a & b"}}}}});
    EXPECT_EQ(markupProblem(svg), "");
}

} // namespace
} // namespace relume
