#include "bake/baker/host_room.h"

#include <gtest/gtest.h>

namespace relume {
namespace {

TEST(HostRoom, WhatDoesNotFitIsRefusedWithTheSizeThatDoes) {
    BakeSettings settings;
    settings.size = 8192;
    const SceneExtent one{.triangles = 1000}, four{.triangles = 1000, .pages = {4}};
    EXPECT_EQ(hostNeeds(settings, four), 4 * hostNeeds(settings, one));
    constexpr uint64_t kFree = uint64_t{8} << 30;
    EXPECT_EQ(hostProblem(settings, one, uint64_t{64} << 30), "");
    const std::string problem = hostProblem(settings, four, kFree);
    ASSERT_TRUE(problem.ends_with(" of 4 pages fits")) << problem;
    settings.size = static_cast<uint32_t>(std::stoul(problem.substr(problem.rfind("--size ") + 7)));
    EXPECT_GE(settings.size, 1024u);
    EXPECT_EQ(hostProblem(settings, four, kFree), "");
    settings.size += 64;
    EXPECT_NE(hostProblem(settings, four, kFree), "");
    EXPECT_NE(hostProblem(settings, four, 0).find("no size fits"), std::string::npos);
}

// On five pages' sheet there is room for nine.
TEST(HostRoom, WhatIsLeftOverOnTheSheetHasNoPatches) {
    BakeSettings settings;
    settings.size = 1024;
    EXPECT_LT(hostNeeds(settings, {.pages = {5}}), hostNeeds(settings, {.pages = {9}}));
    EXPECT_GT(hostNeeds(settings, {.pages = {5}}), hostNeeds(settings, {.pages = {4}}));
}

TEST(HostRoom, MemoryIsReadFromWhatTheKernelTells) {
    EXPECT_EQ(availableIn("MemTotal:  100 kB\nMemAvailable:   2048 kB\nBuffers: 1 kB\n"), 2048u << 10);
    for (const char* text :
         {"", "MemTotal: 5 kB\n", "MemAvailable:", "MemAvailable: x kB", "MemAvailable: 5 MB"})
        EXPECT_EQ(availableIn(text), std::nullopt) << text;
    const std::optional<uint64_t> now = freeHostMemory();
    ASSERT_TRUE(now.has_value());
    EXPECT_GT(*now, uint64_t{1} << 20);
}

} // namespace
} // namespace relume
