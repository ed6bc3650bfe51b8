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
    watch.look({kOld}, kStart);
    EXPECT_FALSE(watch.isDue(kStart + 400ms));
    EXPECT_TRUE(watch.isDue(kStart + 500ms));
    watch.setOn(false);
    EXPECT_FALSE(watch.isDue(kStart + 10s));
}

TEST(FileWatch, AFileIsAnotherOneOnceItStaysAsItIs) {
    FileWatch watch;
    watch.know({{"a.glb"}, {kOld}});
    EXPECT_FALSE(watch.look({kOld}, kStart));
    EXPECT_FALSE(watch.look({kOld}, kStart));
    EXPECT_FALSE(watch.look({kNew}, kStart)) << "its writer may not be done";
    EXPECT_FALSE(watch.look({kNewer}, kStart)) << "and was not";
    EXPECT_TRUE(watch.look({kNewer}, kStart));
    watch.knowSaved("a.glb", kNewer);
    EXPECT_FALSE(watch.look({kNewer}, kStart));
    EXPECT_TRUE(watch.isKnown({{"a.glb"}, {kNewer}}));
    EXPECT_FALSE(watch.isKnown({{"a.glb"}, {kOld}}));
    EXPECT_FALSE(watch.isKnown({{"b.glb"}, {kNewer}}));
}

TEST(FileWatch, AFileThatIsGoneIsNoOtherFile) {
    FileWatch watch;
    watch.know({{"a.glb"}, {kOld}});
    EXPECT_FALSE(watch.look({FileTime()}, kStart));
    EXPECT_FALSE(watch.look({FileTime()}, kStart));
    EXPECT_FALSE(watch.isKnown({{"a.glb"}, {FileTime()}}));
    EXPECT_FALSE(watch.look({kNew}, kStart));
    EXPECT_TRUE(watch.look({kNew}, kStart)) << "it is back, and another one";
}

TEST(FileWatch, AFileBesideTheSceneCountsAsTheSceneDoes) {
    FileWatch watch;
    watch.know({{"a.obj", "a.mtl"}, {kOld, kOld}});
    EXPECT_FALSE(watch.look({kOld, kNew}, kStart)) << "its writer may not be done";
    EXPECT_TRUE(watch.look({kOld, kNew}, kStart));
    EXPECT_FALSE(watch.isKnown({{"a.obj", "a.mtl"}, {kOld, kNew}}));
    EXPECT_FALSE(watch.look({kOld, FileTime()}, kStart));
    EXPECT_TRUE(watch.look({kOld, FileTime()}, kStart)) << "what is gone is told anew, too";
}

TEST(FileWatch, WhatWasSavedNeedsNoLibraryAnyMore) {
    FileWatch watch;
    watch.know({{"a.obj", "a.mtl"}, {kOld, kOld}});
    watch.knowSaved("a.glb", kNew);
    EXPECT_EQ(watch.files().paths, std::vector<std::string>{"a.glb"});
    watch.know({{"a.gltf", "a.bin"}, {kOld, kOld}});
    watch.knowSaved("b.gltf", kNew);
    EXPECT_EQ(watch.files().paths, (std::vector<std::string>{"b.gltf", "a.bin"})) << "it names it still";
}

TEST(FileWatch, FindsTheFilesOfAScene) {
    const TemporaryFolder folder;
    const std::string scene = folder.path("a.obj"), library = folder.path("a.mtl");
    std::ofstream(scene) << "mtllib a.mtl\n";
    std::ofstream(library) << "newmtl a\n";
    const FileSet files = FileSet::of(scene);
    EXPECT_EQ(files.paths, (std::vector{scene, library}));
    EXPECT_EQ(files.times, (std::vector{fileTime(scene), fileTime(library)}));
    std::filesystem::remove(library);
    EXPECT_EQ(files.timesNow(), (std::vector{fileTime(scene), FileTime()}));
}

TEST(FileWatch, ReadsTheTimeOfAFile) {
    const TemporaryFolder folder;
    EXPECT_FALSE(fileTime(folder.path("none")));
    std::ofstream(folder.path("some")) << "text";
    EXPECT_EQ(fileTime(folder.path("some")), std::filesystem::last_write_time(folder.path("some")));
}

} // namespace relume
