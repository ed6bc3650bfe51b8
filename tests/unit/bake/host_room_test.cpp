#include "bake/baker/host_room.h"

#include <gtest/gtest.h>

namespace relume {
namespace {

TEST(HostRoom, MemoryIsReadFromWhatTheKernelTells) {
    EXPECT_EQ(availableIn("MemTotal:  100 kB\nMemAvailable:   2048 kB\nBuffers: 1 kB\n"), 2048u << 10);
    for (const char* text : {"", "OtherMemAvailable: 5 kB", "MemTotal: 5 kB\n",
                             "MemAvailable:", "MemAvailable: 5", "MemAvailable: x kB", "MemAvailable: 5 MB"})
        EXPECT_EQ(availableIn(text), std::nullopt) << text;
    const std::optional<uint64_t> now = freeHostMemory();
    ASSERT_TRUE(now.has_value());
    EXPECT_GT(*now, uint64_t{1} << 20);
}

// A container's limit counts, and what is only a file's copy can be had.
TEST(HostRoom, AGroupsLimitIsReadFromItsFiles) {
    EXPECT_EQ(availableIn({"1000\n", "700\n", "anon 500\ninactive_file 100\nfile 150\n"}), 400u);
    EXPECT_EQ(availableIn({"1000\n", "700\n", "total_inactive_file 100\n"}), 300u) << "of another name";
    EXPECT_EQ(availableIn({"1000\n", "1700\n", ""}), 0u);
    EXPECT_EQ(availableIn({"1000\n", "50\n", "inactive_file 100\n"}), 1000u);
    for (const GroupMemory& none :
         {GroupMemory{}, GroupMemory{"max\n", "700\n", ""}, GroupMemory{"9", "", ""}})
        EXPECT_EQ(availableIn(none), std::nullopt) << none.most;
}

} // namespace
} // namespace relume
