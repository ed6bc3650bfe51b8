#include "app/bench/edits_report.h"

#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "app/bench/light_difference.h"
#include "tests/unit/markup.h"

namespace relume {
namespace {

EditsRun made(uint32_t lamps, double first) {
    EditsRun run;
    run.lamps = lamps;
    run.firstBakeSeconds = 4;
    run.weights = {.seconds = 0.001, .rays = 0, .links = 0, .maximumOfLayers = 1e-6, .maximumOfHybrid = 0.5};
    run.move.firstSeconds = first;
    run.move.firstLayerError = 0.04;
    run.move.seconds5 = first;
    run.move.seconds = 0.5;
    run.move.undoSameBytes = true;
    run.move.curve = {{first, 0.04, 0.02, 0.05}, {0.5, 0.03, 0.01, 0.02}};
    run.layers = {
        .seconds5 = 1, .seconds2 = 3, .seconds = 4, .compositeError = 0.01, .curve = {{1, {}, 0.05, {}}}};
    run.hybrid = {.seconds5 = {}, .seconds2 = {}, .seconds = 2, .compositeError = 0.1, .curve = {}};
    run.albedo = MeasuredAlbedo{
        .material = "Wall", .firstSeconds = 0.1, .firstError = 0.01, .seconds = 0.2, .rays = 0};
    run.object = MeasuredObject{.object = "Chair",
                                .share = 0.01,
                                .firstSeconds = 0.25,
                                .firstError = {},
                                .seconds = 0.5,
                                .freshSeconds = 3.0};
    return run;
}

EditsReport editsReport() {
    EditsReport result;
    result.scene = "room.glb";
    result.device = "a device";
    result.size = 64;
    result.counts = {made(1, 0.010), made(16, 0.012)};
    return result;
}

TEST(EditsReport, JsonHasEveryFigure) {
    const nlohmann::ordered_json json = editsJson(editsReport());
    for (const char* name :
         {"version", "scene", "command", "device", "driver", "tracer", "size", "patches", "error", "samples",
          "referenceSamples", "runs", "diagonal", "lamps", "onlyLamps"})
        EXPECT_TRUE(json.contains(name)) << name;
    EXPECT_NEAR(json.at("firstPictureMostOverLeast"), 1.2, 1e-9);
    ASSERT_EQ(json.at("counts").size(), 2u);
    const auto& run = json.at("counts")[1];
    EXPECT_EQ(run.at("lamps"), 16);
    EXPECT_EQ(run.at("weights").at("rays"), 0);
    EXPECT_EQ(run.at("move").at("secondsTo5Percent"), 0.012);
    EXPECT_TRUE(run.at("move").at("secondsTo2Percent").is_null());
    EXPECT_EQ(run.at("move").at("curve").size(), 2u);
    EXPECT_EQ(run.at("undo").at("sameBytes"), true);
    EXPECT_EQ(run.at("freshLayers").at("overMove"), 8.0);
    EXPECT_NEAR(run.at("freshLayers").at("overMoveTo5Percent"), 1 / 0.012, 1e-9);
    EXPECT_TRUE(run.at("freshLayers").at("overMoveTo2Percent").is_null()); // the move never came so far
    EXPECT_TRUE(run.at("freshLayers").at("curve")[0].at("layerError").is_null());
    EXPECT_EQ(run.at("freshHybrid").at("overMove"), 4.0);
    EXPECT_TRUE(run.at("freshHybrid").at("overMoveTo5Percent").is_null());
    EXPECT_EQ(run.at("albedo").at("material"), "Wall");
    EXPECT_EQ(run.at("object").at("object"), "Chair");
    EXPECT_DOUBLE_EQ(run.at("object").at("overObject"), 6.0);
    EXPECT_DOUBLE_EQ(run.at("object").at("overFirst"), 12.0);
    EXPECT_TRUE(run.at("object").at("firstError").is_null());
}

TEST(EditsReport, AlbedoMayBeMissing) {
    EditsReport without = editsReport();
    without.counts[0].albedo.reset();
    EXPECT_TRUE(editsJson(without).at("counts")[0].at("albedo").is_null());
    EXPECT_NE(editsTable(without).find("–"), std::string::npos);
}

TEST(EditsReport, TableHasAColumnForEachNumberOfLamps) {
    const std::string table = editsTable(editsReport());
    EXPECT_NE(table.find("move: first picture after             10 ms        12 ms\n"), std::string::npos)
        << table;
    EXPECT_NE(table.find("most over least: 1.2\n"), std::string::npos);
}

TEST(EditsReport, PlotIsOfTheMostLamps) {
    const PlotDesc desc = editsPlot(editsReport());
    EXPECT_NE(desc.title.find("16 lamps"), std::string::npos);
    ASSERT_EQ(desc.series.size(), 4u);
    EXPECT_EQ(desc.series[0].points.size(), 2u);
    EXPECT_EQ(desc.series[0].points[1].y, 0.01);
    EXPECT_EQ(desc.series[1].points[1].y, 0.03);
    EXPECT_EQ(desc.series[2].points.size(), 1u);
    EXPECT_EQ(markupProblem(logLogPlotFile(desc)), "");
}

TEST(EditsReport, MediansAndTimes) {
    EXPECT_EQ(median(std::vector<double>{3, 1, 2}), 2.0);
    EXPECT_EQ(median(std::vector<double>{4, 1, 2, 3}), 2.0);
    EXPECT_EQ(median(std::vector<double>{}), 0.0);
    using Optionals = std::vector<std::optional<double>>;
    EXPECT_EQ(median(Optionals{5.0, 1.0, 2.0}), 2.0);
    EXPECT_FALSE(median(Optionals{5.0, {}}).has_value());
    const std::vector<EditErrorPoint> curve = {{1, 0.1, 0.04, {}}, {2, 0.05, 0.01, {}}, {3, 0.01, 0.02, {}}};
    EXPECT_EQ(secondsTo(curve, 0.05, true), 2.0);
    EXPECT_EQ(secondsTo(curve, 0.05, false), 1.0);
    EXPECT_FALSE(secondsTo(curve, 0.005, true).has_value());
}

PatchSet patchesOf(const std::vector<uint32_t>& flags) {
    PatchSet patches;
    for (const uint32_t f : flags) {
        shader::Patch patch{};
        patch.flags = f;
        patches.scene.patches.push_back(patch);
    }
    patches.count = static_cast<uint32_t>(flags.size());
    return patches;
}

TEST(LightDifference, CountsPatchesThatAreShown) {
    const PatchSet patches = patchesOf(
        {shader::kPatchSends, shader::kPatchSends, 0, shader::kPatchSends | shader::kPatchBackSide});
    const PatchLight reference = {glm::vec4(1), glm::vec4(3), glm::vec4(100), glm::vec4(100)};
    const PatchLight light = {glm::vec4(1), glm::vec4(2), glm::vec4(0), glm::vec4(0)};
    const LightDifference found = compareLight(patches, light, reference);
    EXPECT_NEAR(found.relRmse, std::sqrt(0.5) / 2, 1e-12);
    EXPECT_NEAR(found.maximum, 0.5, 1e-12);
    const LightDifference scaled = compareLight(patches, light, reference, glm::vec3(1.5f));
    EXPECT_NEAR(scaled.relRmse, std::sqrt(0.125) / 2, 1e-12);
    EXPECT_EQ(compareLight(patches, reference, reference).relRmse, 0.0);
}

TEST(LightDifference, OfBlackness) {
    const PatchSet patches = patchesOf({shader::kPatchSends});
    EXPECT_EQ(compareLight(patches, {glm::vec4(0)}, {glm::vec4(0)}).relRmse, 0.0);
    EXPECT_TRUE(std::isinf(compareLight(patches, {glm::vec4(1)}, {glm::vec4(0)}).relRmse));
}

} // namespace
} // namespace relume
