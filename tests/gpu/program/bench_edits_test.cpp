// This runs `relume bench edits` as a user does, on a room small enough for any device.
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/gpu/relume_process.h"
#include "tests/temporary_folder.h"
#include "tests/text.h"
#include "tests/unit/markup.h"

namespace relume {
namespace {

void expectCurve(const nlohmann::json& curve, double seconds) {
    ASSERT_FALSE(curve.empty());
    double last = 0;
    for (const auto& point : curve) {
        EXPECT_GT(point.at("seconds"), last);
        last = point.at("seconds");
        EXPECT_GT(point.at("compositeError"), 0.0);
    }
    EXPECT_EQ(last, seconds);
}

void expectFresh(const nlohmann::json& bake, double moveSeconds) {
    const double seconds = bake.at("seconds");
    EXPECT_GT(bake.at("rays"), 0);
    EXPECT_LT(bake.at("compositeError"), 0.1);
    EXPECT_NEAR(bake.at("overMove"), seconds / moveSeconds, 1e-6 * seconds / moveSeconds);
    for (const char* name :
         {"secondsTo5Percent", "secondsTo2Percent", "overMoveTo5Percent", "overMoveTo2Percent"})
        EXPECT_TRUE(bake.contains(name)) << name;
    expectCurve(bake.at("curve"), seconds);
}

void expectCount(const nlohmann::json& run) {
    EXPECT_GT(run.at("firstBakeSeconds"), 0.0);
    const auto& weights = run.at("weights");
    EXPECT_GT(weights.at("seconds"), 0.0);
    EXPECT_EQ(weights.at("rays"), 0);
    EXPECT_EQ(weights.at("links"), 0);
    EXPECT_LT(weights.at("maximumOverMean"), 1e-3);
    EXPECT_GT(weights.at("maximumOverMeanOfHybrid"), 0.0); // which samples otherwise
    const auto& move = run.at("move");
    EXPECT_GT(move.at("firstSeconds"), 0.0);
    EXPECT_LE(move.at("firstSeconds"), move.at("seconds"));
    EXPECT_LT(move.at("firstLayerError"), 0.5);
    EXPECT_LT(move.at("firstCompositeError"), 0.5);
    EXPECT_LT(move.at("layerError"), 0.1);
    EXPECT_LT(move.at("compositeError"), 0.1);
    for (const char* name : {"secondsTo5Percent", "secondsTo2Percent"})
        EXPECT_TRUE(move.contains(name)) << name;
    EXPECT_GT(move.at("rays"), 0);
    expectCurve(move.at("curve"), move.at("seconds"));
    EXPECT_GT(run.at("undo").at("seconds"), 0.0);
    EXPECT_EQ(run.at("undo").at("sameBytes"), true);
    expectFresh(run.at("freshLayers"), move.at("seconds"));
    expectFresh(run.at("freshHybrid"), move.at("seconds"));
    const auto& albedo = run.at("albedo");
    EXPECT_GT(albedo.at("firstSeconds"), 0.0);
    EXPECT_LE(albedo.at("firstSeconds"), albedo.at("seconds"));
    EXPECT_EQ(albedo.at("rays"), 0);
    const auto& object = run.at("object");
    EXPECT_GT(object.at("shareOfTriangles"), 0.0);
    EXPECT_LT(object.at("followSeconds"), object.at("firstSeconds"));
    EXPECT_LE(object.at("firstSeconds"), object.at("seconds"));
    EXPECT_LT(object.at("firstError"), 0.2);
    EXPECT_GT(object.at("rays"), 0);
    EXPECT_GT(object.at("freshRays"), 0);    // of a box in a box there is little to save
    EXPECT_LT(object.at("difference"), 0.1); // both have the error that was asked for, at levels of their own
    const auto& links = run.at("links");
    EXPECT_GT(links.at("perSecondMove"), 0.0);
    EXPECT_GT(links.at("perSecondAlbedo"), 0.0);
    EXPECT_GT(links.at("bytes"), 0);
    EXPECT_NEAR(links.at("bytesPerLink"), 4.0, 0.5); // chunks are not full everywhere
}

TEST(BenchEdits, TellsEveryFigure) {
    const TemporaryFolder folder;
    const std::string scene = folder.path("room.glb"), json = folder.path("edits.json"),
                      plot = folder.path("edits.svg");
    ASSERT_EQ(runRelume({"scene", "cornell_small", "-o", scene}).status, 0);
    const ProcessResult run =
        runRelume({"bench", "edits", scene, "--size", "64", "--lights", "2,1", "--error", "0.03", "--samples",
                   "32", "--reference-samples", "1024", "--runs", "2", "--json", json, "--plot", plot});
    ASSERT_EQ(run.status, 0) << run.err;
    EXPECT_NE(run.out.find("device: "), std::string::npos) << run.out;
    EXPECT_NE(run.out.find("materials and sky of the scene do not shine"), std::string::npos) << run.out;
    const auto report = nlohmann::json::parse(bytesOf(json));
    EXPECT_FALSE(report.at("device").get<std::string>().empty());
    EXPECT_EQ(report.at("size"), 64);
    EXPECT_GE(report.at("firstPictureMostOverLeast"), 1.0);
    ASSERT_EQ(report.at("counts").size(), 2u);
    EXPECT_EQ(report.at("counts")[0].at("lamps"), 1);
    EXPECT_EQ(report.at("counts")[1].at("lamps"), 2);
    for (const auto& count : report.at("counts"))
        expectCount(count);
    EXPECT_EQ(markupProblem(bytesOf(plot)), "");
}

} // namespace
} // namespace relume
