#include "app/bench/quality/quality_report.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/unit/markup.h"

namespace relume {
namespace {

QualityPoint at(uint64_t rays, double seconds, double local95, double relRmse) {
    QualityPoint point;
    point.rays = rays;
    point.seconds = seconds;
    point.local95 = local95;
    point.relRmse = relRmse;
    point.flip = {0.01, 0.03};
    return point;
}

QualityReport qualityReport() {
    QualityReport made;
    made.scene = "a/room.glb";
    made.size = 64;
    made.error = 0.01;
    made.pictures = {"start", "dark place"};
    made.runs = {{.mode = "plain",
                  .patches = 9,
                  .points = {at(100, 1, 0.4, 0.1), at(1600, 16, 0.1, 0.02)},
                  .note = {}},
                 {.mode = "layers", .patches = 9, .points = {}, .note = "no room"}};
    return made;
}

TEST(QualityReport, CurvesRunStraightBetweenPointsInLogarithms) {
    const auto points = qualityReport().runs[0].points; // a quarter of the error takes 16 times the rays
    const auto half = reachedAt(points, &QualityPoint::local95, 0.2);
    ASSERT_TRUE(half);
    EXPECT_NEAR(half->rays, 400, 1e-9);
    EXPECT_NEAR(half->seconds, 4, 1e-9);
    EXPECT_FALSE(half->atMost);
    EXPECT_NEAR(reachedAt(points, &QualityPoint::local95, 0.1)->rays, 1600, 1e-6);
    EXPECT_FALSE(reachedAt(points, &QualityPoint::local95, 0.05));
    const auto first = reachedAt(points, &QualityPoint::local95, 0.5);
    ASSERT_TRUE(first);
    EXPECT_EQ(first->rays, 100);
    EXPECT_TRUE(first->atMost);
    EXPECT_FALSE(reachedAt({}, &QualityPoint::local95, 0.5));
}

TEST(QualityReport, CurvesMayComeFromInfinityOrEndAtNothing) {
    const double infinity = std::numeric_limits<double>::infinity();
    for (const auto& points : {std::vector{at(100, 1, infinity, 1), at(200, 2, 0.1, 1)},
                               std::vector{at(100, 1, 0.4, 1), at(200, 2, 0, 1)}}) {
        const auto reached = reachedAt(points, &QualityPoint::local95, 0.2);
        ASSERT_TRUE(reached);
        EXPECT_EQ(reached->rays, 200);
        EXPECT_TRUE(reached->atMost);
    }
}

TEST(QualityReport, JsonHasEveryFigure) {
    QualityReport made = qualityReport();
    made.runs[0].points[0].local99 = std::numeric_limits<double>::infinity();
    const nlohmann::ordered_json told = qualityJson(made);
    for (const char* name : {"version", "scene", "command", "device", "driver", "tracer", "size", "error",
                             "localError", "reference", "pictures", "interrupted"})
        EXPECT_TRUE(told.contains(name)) << name;
    ASSERT_EQ(told.at("runs").size(), 2u);
    const auto& run = told.at("runs")[0];
    EXPECT_EQ(run.at("mode"), "plain");
    EXPECT_NEAR(run.at("reached").at("localError20").at("rays"), 400, 1e-9);
    EXPECT_TRUE(run.at("reached").at("localError5").is_null());
    EXPECT_TRUE(run.at("reached").at("error").is_null());
    const auto& point = run.at("points")[0];
    for (const char* name : {"samples", "rays", "seconds", "processSeconds", "relRMSE", "toldError",
                             "local50", "local95", "local99", "toldLocal95", "toldLocal99"})
        EXPECT_TRUE(point.contains(name)) << name;
    EXPECT_TRUE(point.at("local99").is_null());
    EXPECT_EQ(point.at("FLIP").size(), 2u);
    EXPECT_FALSE(run.contains("note"));
    EXPECT_EQ(told.at("runs")[1].at("note"), "no room");
}

TEST(QualityReport, TableAndPlot) {
    const std::string table = qualityTable(qualityReport());
    EXPECT_NE(table.find("0.010 0.030"), std::string::npos) << table;
    EXPECT_NE(table.find("local error 20 %   0.0004 Mrays, 4 s\n"), std::string::npos) << table;
    EXPECT_NE(table.find("relRMSE 1 %        not reached\n"), std::string::npos) << table;
    const PlotDesc time = qualityPlot(qualityReport(), false), rays = qualityPlot(qualityReport(), true);
    ASSERT_EQ(time.series.size(), 6u);
    EXPECT_EQ(time.series[0].points[1].x, 16);
    EXPECT_EQ(rays.series[0].points[1].x, 1600);
    EXPECT_EQ(time.series[0].points[1].y, 0.1);
    EXPECT_EQ(time.series[1].points[1].y, 0.02);
    EXPECT_EQ(time.series[2].points[1].y, 0.02);
    EXPECT_EQ(markupProblem(logLogPlotFile(rays)), "");
}

} // namespace
} // namespace relume
