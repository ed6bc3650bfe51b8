#include "bake/baker/host_room.h"

#include <gtest/gtest.h>

namespace relume {
namespace {

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
