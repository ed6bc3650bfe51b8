// This runs `relume bench frames` as a user does: what is measured is a bake that goes on.
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/gpu/relume_process.h"
#include "tests/temporary_folder.h"

namespace relume {
namespace {

void expectRays(const std::vector<std::string>& options) {
    const TemporaryFolder folder;
    const std::string json = folder.path("frames.json");
    std::vector<std::string> line = {"bench", "frames", RELUME_SOURCE_DIR "/assets/scenes/cornell_small.glb"};
    line.insert(line.end(), options.begin(), options.end());
    line.insert(line.end(), {"--width", "64", "--height", "64", "--seconds", "1", "--json", json});
    const ProcessResult run = runRelume(line);
    ASSERT_EQ(run.status, 0) << run.err;
    std::ifstream stream(json);
    const nlohmann::json report = nlohmann::json::parse(stream);
    for (const char* part : {"bakeAlone", "cameraMoves", "cameraStill"})
        EXPECT_GT(report[part]["raysPerSecond"].get<double>(), 0) << part;
    EXPECT_EQ(report["framesAlone"]["raysPerSecond"].get<double>(), 0);
    EXPECT_GT(report["framesAlone"]["frames"].get<int>(), 0);
}

TEST(BenchFrames, CountsRaysOfStepsThatLast) {
    expectRays({"--lightmap-size", "128"});
}

// All bounces that there can be are over in a moment.
TEST(BenchFrames, BeginsAgainWhereABakeEnds) {
    expectRays({"--method", "pure", "--cache", "none", "--lightmap-size", "8"});
}

} // namespace
} // namespace relume
