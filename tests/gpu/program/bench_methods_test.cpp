// This runs `relume bench methods` as a user does, on a room small enough for any device.
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "assets/gltf/gltf.h"
#include "tests/gpu/bake_scene.h"
#include "tests/gpu/relume_process.h"
#include "tests/temporary_folder.h"
#include "tests/text.h"
#include "tests/unit/markup.h"

namespace relume {
namespace {

class BenchMethods : public testing::Test {
protected:
    BenchMethods() {
        SceneMaker maker(64);
        maker.box({0, 0, 0}, {glm::vec3(2, 0, 0), {0, 2, 0}, {0, 0, 2}}, maker.material(0.5f, 1.0f), 14);
        saveGlb(maker.scene(), scene_);
    }
    TemporaryFolder folder_;
    const std::string scene_ = folder_.path("room.glb");
};

TEST_F(BenchMethods, WritesItsReport) {
    const std::string html = folder_.path("report.html"), json = folder_.path("report.json");
    const ProcessResult run =
        runRelume({"bench", "methods", scene_, "--sizes", "128,64", "--methods", "static,pure", "--windows",
                   "2", "--reference-samples", "64", "--html", html, "--json", json});
    ASSERT_EQ(run.status, 0) << run.err;
    EXPECT_NE(run.out.find("window 2"), std::string::npos) << run.out;
    const auto report = nlohmann::json::parse(bytesOf(json));
    ASSERT_EQ(report.at("runs").size(), 4u);
    for (size_t i = 0; i < 4; ++i) {
        const auto& entry = report.at("runs")[i];
        EXPECT_EQ(entry.at("size"), i < 2 ? 64 : 128);
        EXPECT_EQ(entry.at("method"), i % 2 == 0 ? "pure" : "static"); // what the others are compared with
        EXPECT_GT(entry.at("solveSeconds"), 0.0);
        EXPECT_GT(entry.at("totalSeconds"), entry.at("solveSeconds"));
        EXPECT_GT(entry.at("rays"), 0);
        EXPECT_LT(entry.at("DFPR"), 0.05);
        EXPECT_LT(entry.at("relRMSE"), 0.1);
        EXPECT_GT(entry.at("localError"), 0.0);
        EXPECT_FALSE(entry.contains("note"));
    }
    EXPECT_EQ(report.at("runs")[0].at("DFPR"), 0.0);
    const std::string page = bytesOf(html);
    EXPECT_EQ(markupProblem(page), "");
    EXPECT_NE(page.find("data:image/png;base64,iVBOR"), std::string::npos);
}

TEST_F(BenchMethods, NotesWhatTakesTooLong) {
    const ProcessResult run =
        runRelume({"bench", "methods", scene_, "--sizes", "64", "--methods", "pure", "--max-seconds", "1e-9",
                   "--html", folder_.path("report.html"), "--json", "-"});
    ASSERT_EQ(run.status, 0) << run.err;
    const auto runs = nlohmann::json::parse(run.out).at("runs");
    ASSERT_EQ(runs.size(), 1u);
    EXPECT_TRUE(runs[0].at("solveSeconds").is_null());
    EXPECT_NE(runs[0].at("note").get<std::string>().find("--max-seconds"), std::string::npos);
}

} // namespace
} // namespace relume
