// This runs `relume bench quality` as a user does, on a room small enough for any device.
#include <filesystem>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/gpu/relume_process.h"
#include "tests/temporary_folder.h"
#include "tests/unit/markup.h"

namespace relume {
namespace {

std::string contentOf(const std::string& name) {
    std::ifstream in(name);
    return {std::istreambuf_iterator<char>(in), {}};
}

TEST(BenchQuality, TellsEveryFigure) {
    const TemporaryFolder folder;
    const std::string scene = folder.path("room.glb"), json = folder.path("quality.json"),
                      plot = folder.path("quality.svg"), reference = folder.path("reference.exr");
    ASSERT_EQ(runRelume({"scene", "cornell_small", "-o", scene}).status, 0);
    const ProcessResult run =
        runRelume({"bench", "quality", scene, "--size", "64", "--error", "0.03", "--local-error", "0",
                   "--reference-samples", "256", "--reference", reference, "--json", json, "--plot", plot,
                   "--pictures", folder.path("pictures")});
    ASSERT_EQ(run.status, 0) << run.err;
    EXPECT_NE(run.out.find("local error 20 %"), std::string::npos) << run.out;
    EXPECT_EQ(markupProblem(contentOf(plot)), "");
    EXPECT_TRUE(std::filesystem::exists(reference));
    const auto report = nlohmann::json::parse(contentOf(json));
    const size_t pictures = report.at("pictures").size();
    EXPECT_GE(pictures, 1u);
    ASSERT_EQ(report.at("runs").size(), 4u);
    for (const auto& mode : report.at("runs")) {
        EXPECT_FALSE(mode.contains("note")) << mode.at("mode");
        ASSERT_FALSE(mode.at("points").empty());
        double rays = 0;
        for (const auto& point : mode.at("points")) {
            EXPECT_GE(point.at("rays"), rays); // a layer may go on with links that others traced
            rays = point.at("rays");
            EXPECT_GT(point.at("processSeconds"), point.at("seconds"));
            EXPECT_LE(point.at("local50"), point.at("local95"));
            EXPECT_LE(point.at("local95"), point.at("local99"));
            EXPECT_EQ(point.at("FLIP").size(), pictures);
        }
        EXPECT_LT(mode.at("points").back().at("relRMSE"), 0.1);
    }
    EXPECT_TRUE(std::filesystem::exists(folder.path("pictures/reference-1.png")));
    EXPECT_TRUE(std::filesystem::exists(folder.path("pictures/per-chunk-1.png")));

    // A reference that is there is read, of another size refused.
    const ProcessResult again =
        runRelume({"bench", "quality", scene, "--size", "64", "--modes", "per-chunk", "--rays", "1",
                   "--no-pictures", "--reference", reference, "--json", "-"});
    ASSERT_EQ(again.status, 0) << again.err;
    const auto second = nlohmann::json::parse(again.out);
    EXPECT_EQ(second.at("reference"), reference);
    EXPECT_TRUE(second.at("runs")[0].at("points")[0].at("FLIP").empty());
    EXPECT_EQ(second.at("runs")[0].at("converged"), false);
    EXPECT_EQ(runRelume({"bench", "quality", scene, "--size", "32", "--reference", reference}).status, 1);
}

} // namespace
} // namespace relume
