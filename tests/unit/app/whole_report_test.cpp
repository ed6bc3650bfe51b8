#include "app/bench/whole_report.h"

#include <gtest/gtest.h>

namespace relume {
namespace {

WholeBake someBake() {
    return {
        .tracer = "embree",
        .size = 64,
        .patches = 4000,
        .triangles = 12,
        .phases = {{"load", 0.25, 0.25}, {"solve", 1.5, 3.0}, {"write", 0.125, 0.25}, {"other", 0.125, 0.0}}};
}

TEST(WholeReport, SumsArePartsAndPartsWithoutTheSolver) {
    EXPECT_DOUBLE_EQ(wholeOf(someBake()).seconds, 2.0);
    EXPECT_DOUBLE_EQ(wholeOf(someBake()).cpuSeconds, 3.5);
    EXPECT_DOUBLE_EQ(besideSolver(someBake()).seconds, 0.5);
    EXPECT_DOUBLE_EQ(besideSolver(someBake()).cpuSeconds, 0.5);
}

TEST(WholeReport, JsonHasEveryPart) {
    const nlohmann::ordered_json told = wholeJson(someBake());
    EXPECT_EQ(told.at("seconds").at("load"), 0.25);
    EXPECT_EQ(told.at("cpuSeconds").at("solve"), 3.0);
    EXPECT_EQ(told.at("seconds").at("sum"), 2.0);
    EXPECT_EQ(told.at("seconds").at("all but solve"), 0.5);
    EXPECT_EQ(told.at("seconds").size(), 6u);
    EXPECT_EQ(told.at("tracer"), "embree");
    EXPECT_EQ(told.at("size"), 64);
}

TEST(WholeReport, TableHasARowPerPart) {
    EXPECT_EQ(wholeTable(someBake()), "64 x 64, 4000 patches, 12 triangles, embree\n"
                                      "part                   s     CPU s   share\n"
                                      "load               0.250     0.250  12.5 %\n"
                                      "solve              1.500     3.000  75.0 %\n"
                                      "write              0.125     0.250   6.2 %\n"
                                      "other              0.125     0.000   6.2 %\n"
                                      "all but solve      0.500     0.500  25.0 %\n"
                                      "sum                2.000     3.500 100.0 %\n");
    EXPECT_NE(wholeTable({}).find("sum"), std::string::npos); // nothing is divided by nothing
}

} // namespace
} // namespace relume
