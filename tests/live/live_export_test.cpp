// These tests export while a bake goes on, waits, fails or ends.
#include "app/live/lightmap_export.h"
#include "tests/live/live_bake_fixture.h"
#include "tests/temporary_folder.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <new>
#include <stdexcept>

namespace relume {
namespace {

class LiveExport : public LiveBakeTest {
protected:
    bool written(const char* name) const { return std::filesystem::exists(folder_.path(name)); }
    BakeOrders::Export order(const char* name) const {
        return {.path = folder_.path(name), .lightmap = {}, .scene = "scene.glb"};
    }
    const TemporaryFolder folder_;
};

TEST_F(LiveExport, WhatWasAskedForBeforeTheEndIsWritten) {
    start(quickSettings(), false);
    ASSERT_TRUE(untilShown());
    bake_.exportLightmap(order("last.exr"));
    bake_.stop();
    EXPECT_TRUE(written("last.exr"));
}

TEST_F(LiveExport, WhatTheEndComesBeforeIsTold) {
    testing::internal::CaptureStdout();
    start(quickSettings(), false);
    bake_.exportLightmap(order("early.exr"));
    bake_.stop();
    const std::string told = testing::internal::GetCapturedStdout();
    if (!written("early.exr")) { // it was being prepared
        EXPECT_NE(told.find("early.exr: not written, as the viewer was closed"), std::string::npos) << told;
    }
}

// A paused bake goes on until it can follow the edit before the export.
TEST_F(LiveExport, APausedBakeIsExportedWithTheEditBefore) {
    BakeSettings settings = quickSettings();
    settings.solver.layers.on = true;
    settings.solver.error = 0.002; // so long that it is amid something
    start(settings, false);
    bake_.setBatchMs(1);
    ASSERT_TRUE(until([&] { return isIn(BakeStatus::Phase::Baking); }));
    for (int i = 0; i < 8; ++i) {
        bake_.pause();
        ASSERT_TRUE(until([&] { return isIn(BakeStatus::Phase::Paused) || isIn(BakeStatus::Phase::Done); }));
        edits_.placements.back().transform[3].x += 0.01f; // objects wait until the bake is at rest
        start(settings);
        bake_.pause();
        const std::string name = "paused" + std::to_string(i) + ".exr";
        bake_.exportLightmap(order(name.c_str()));
        ASSERT_TRUE(until([&] { return written(name.c_str()); })) << i;
        bake_.step();
    }
}

TEST_F(LiveExport, OneThatGoesWrongLeavesTheBake) {
    SceneBake bake;
    const BakeOrders::Start begun{
        .scene = &scene_, .edits = edits_, .settings = quickSettings(), .keepLight = true};
    bake.takeUp(begun, 8.0);
    bake.make(testDevice(), begun);
    ASSERT_FALSE(bake.baker()->solver().done());
    testing::internal::CaptureStdout();
    EXPECT_NO_THROW(
        exportLightmap(order("full.exr"), bake, []() -> std::vector<glm::vec4> { throw std::bad_alloc(); }));
    EXPECT_NO_THROW(exportLightmap(order("odd.exr"), bake,
                                   []() -> std::vector<glm::vec4> { throw std::length_error("odd"); }));
    const std::string told = testing::internal::GetCapturedStdout();
    EXPECT_NE(told.find("full.exr: not written, as the memory is full"), std::string::npos) << told;
    EXPECT_NE(told.find("odd.exr: not written: odd"), std::string::npos) << told;
    EXPECT_FALSE(written("full.exr"));
}

} // namespace
} // namespace relume
