#include "app/live/file_watch.h"
#include "tests/temporary_folder.h"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>

namespace relume {
namespace {

using namespace std::chrono_literals;

constexpr std::filesystem::file_time_type kOld{}, kNew = kOld + 1s, kNewer = kOld + 2s;
const Clock::time_point kStart = Clock::time_point{} + 1h;

} // namespace

TEST(FileWatch, LooksOnlyWhileItIsOnAndOncePerPeriod) {
    FileWatch watch;
    EXPECT_FALSE(watch.isDue(kStart));
    watch.setOn(true);
    EXPECT_TRUE(watch.isDue(kStart));
    watch.look(kOld, kStart);
    EXPECT_FALSE(watch.isDue(kStart + 400ms));
    EXPECT_TRUE(watch.isDue(kStart + 500ms));
    watch.setOn(false);
    EXPECT_FALSE(watch.isDue(kStart + 10s));
}

TEST(FileWatch, AFileIsAnotherOneOnceItStaysAsItIs) {
    FileWatch watch;
    watch.know(kOld);
    EXPECT_FALSE(watch.look(kOld, kStart));
    EXPECT_FALSE(watch.look(kOld, kStart));
    EXPECT_FALSE(watch.look(kNew, kStart)) << "its writer may not be done";
    EXPECT_FALSE(watch.look(kNewer, kStart)) << "and was not";
    EXPECT_TRUE(watch.look(kNewer, kStart));
    watch.know(kNewer);
    EXPECT_FALSE(watch.look(kNewer, kStart));
    EXPECT_TRUE(watch.isKnown(kNewer));
    EXPECT_FALSE(watch.isKnown(kOld));
}

TEST(FileWatch, AFileThatIsGoneIsNoOtherFile) {
    FileWatch watch;
    watch.know(kOld);
    EXPECT_FALSE(watch.look({}, kStart));
    EXPECT_FALSE(watch.look({}, kStart));
    EXPECT_FALSE(watch.isKnown({}));
    EXPECT_FALSE(watch.look(kNew, kStart));
    EXPECT_TRUE(watch.look(kNew, kStart)) << "it is back, and another one";
}

TEST(FileWatch, ReadsTheTimeOfAFile) {
    const TemporaryFolder folder;
    EXPECT_FALSE(fileTime(folder.path("none")));
    std::ofstream(folder.path("some")) << "text";
    EXPECT_EQ(fileTime(folder.path("some")), std::filesystem::last_write_time(folder.path("some")));
}

} // namespace relume
