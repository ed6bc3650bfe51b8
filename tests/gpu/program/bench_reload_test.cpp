// This runs `relume bench reload` as a user does: files that another program writes are edits of the bake.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/gpu/relume_process.h"
#include "tests/temporary_folder.h"

namespace relume {
namespace {

TEST(BenchReload, AFileIsAsGoodAsAnEdit) {
    const TemporaryFolder folder;
    const std::string scene = folder.path("room.glb");
    ASSERT_EQ(runRelume({"scene", "cornell_small", "-o", scene}).status, 0);
    const ProcessResult run = runRelume({"bench", "reload", scene, "--lights", "3", "--size", "64",
                                         "--samples", "64", "--runs", "1", "--changes", "12", "--json", "-"});
    ASSERT_EQ(run.status, 0) << run.err;
    const auto report = nlohmann::json::parse(run.out);
    EXPECT_EQ(report.at("beginnings"), 1) << "no file began the bake anew";
    EXPECT_GT(report.at("readSeconds"), 0.0);
    ASSERT_EQ(report.at("edits").size(), 6u);
    for (const auto& edit : report.at("edits")) {
        EXPECT_GT(edit.at("fileSeconds"), 0.0);
        EXPECT_GT(edit.at("viewerSeconds"), 0.0);
        const double rays = edit.at("fileRays"), own = edit.at("viewerRays");
        EXPECT_LE(rays, 1.05 * own) << edit.at("edit");
    }
    const auto& lamp = report.at("edits")[0];
    EXPECT_GT(lamp.at("fileRays"), 0);
    EXPECT_EQ(lamp.at("otherLayers"), 2);
    EXPECT_EQ(lamp.at("otherLayersKept"), 2) << "the other lamps' light stays to the bit";
    for (const size_t colour : {4u, 5u})
        EXPECT_EQ(report.at("edits")[colour].at("fileRays"), 0)
            << report.at("edits")[colour].at("edit") << " costs no ray";
    EXPECT_EQ(report.at("randomChanges"), 12);
    EXPECT_EQ(report.at("differenceFromFresh"), 0.0) << "at the same number of samples";
}

} // namespace
} // namespace relume
