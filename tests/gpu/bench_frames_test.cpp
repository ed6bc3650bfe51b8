// `relume bench frames` as a user runs it.
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/gpu/relume_process.h"
#include "tests/temporary_folder.h"

namespace relume {
namespace {

// A scene this small is baked to its end at once; what is measured must go on.
TEST(BenchFrames, MeasuresABakeThatGoesOn) {
    const TemporaryFolder folder;
    const std::string json = folder.path("frames.json");
    const std::string scene = std::string(RELUME_SOURCE_DIR) + "/assets/scenes/cornell_small.glb";
    const ProcessResult run =
        runRelume({"bench", "frames", scene, "--method", "pure", "--lightmap-size", "8", "--width", "64",
                   "--height", "64", "--seconds", "0.5", "--json", json});
    ASSERT_EQ(run.status, 0) << run.err;
    std::ifstream stream(json);
    const nlohmann::json report = nlohmann::json::parse(stream);
    for (const char* part : {"bakeAlone", "cameraMoves", "cameraStill"})
        EXPECT_GT(report[part]["raysPerSecond"].get<double>(), 0) << part;
    EXPECT_EQ(report["framesAlone"]["raysPerSecond"].get<double>(), 0);
    EXPECT_GT(report["framesAlone"]["frames"].get<int>(), 0);
}

} // namespace
} // namespace relume
