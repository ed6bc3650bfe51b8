#include "app/live/watch/file_news.h"
#include "app/live/watch/file_watch.h"
#include "tests/temporary_folder.h"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <semaphore>

namespace relume {
namespace {

using namespace std::chrono_literals;

constexpr std::filesystem::file_time_type kOld{}, kNew = kOld + 1s, kNewer = kOld + 2s;
const Clock::time_point kStart = Clock::time_point{} + 1h;

// Looks half a second after the last time.
bool lookLater(FileWatch& watch, const std::vector<FileTime>& times) {
    static Clock::time_point now = kStart;
    return watch.look({.times = times}, now += 500ms) == FileChange::Settled;
}

} // namespace

TEST(FileWatch, LooksOnlyWhileItIsOnAndOncePerPeriod) {
    FileWatch watch;
    EXPECT_FALSE(watch.isDue(kStart));
    watch.setOn(true);
    EXPECT_TRUE(watch.isDue(kStart));
    watch.look({.times = {kOld}}, kStart);
    EXPECT_FALSE(watch.isDue(kStart + 90ms));
    EXPECT_TRUE(watch.isDue(kStart + 100ms));
    watch.setOn(false);
    EXPECT_FALSE(watch.isDue(kStart + 10s));
}

TEST(FileWatch, AFileIsAnotherOneOnceItStaysAsItIs) {
    FileWatch watch;
    watch.know({{"a.glb"}, {kOld}});
    EXPECT_FALSE(lookLater(watch, {kOld}));
    EXPECT_FALSE(lookLater(watch, {kOld}));
    EXPECT_FALSE(lookLater(watch, {kNew})) << "its writer may not be done";
    EXPECT_FALSE(lookLater(watch, {kNewer})) << "and was not";
    EXPECT_TRUE(lookLater(watch, {kNewer}));
    watch.knowSaved("a.glb", kNewer);
    EXPECT_FALSE(lookLater(watch, {kNewer}));
    EXPECT_TRUE(watch.isKnown({{"a.glb"}, {kNewer}}));
    EXPECT_FALSE(watch.isKnown({{"a.glb"}, {kOld}}));
    EXPECT_FALSE(watch.isKnown({{"b.glb"}, {kNewer}}));
}

TEST(FileWatch, AFileThatIsWholeByItsOwnWordsWaitsForOneLookOnly) {
    FileWatch watch;
    watch.know({{"a.glb"}, {kOld}});
    EXPECT_EQ(FileChange::None, watch.look({.times = {kNew}, .whole = true}, kStart));
    EXPECT_EQ(FileChange::Hasty, watch.look({.times = {kNew}, .whole = true}, kStart + 100ms));

    EXPECT_EQ(FileChange::Hasty,
              watch.look({.times = {kNewer}, .whole = true, .finished = true}, kStart + 200ms));

    watch.know({{"a.glb"}, {kNew}});
    watch.look({.times = {kOld}}, kStart + 300ms);
    EXPECT_EQ(FileChange::None, watch.look({.times = {kNewer}, .whole = false}, kStart + 1s));
    EXPECT_EQ(FileChange::None, watch.look({.times = {kNewer}, .whole = false}, kStart + 1400ms))
        << "its writer may pause";
    EXPECT_EQ(FileChange::Settled, watch.look({.times = {kNewer}, .whole = false}, kStart + 1500ms));
}

TEST(FileWatch, OneOfSeveralFilesThatIsFinishedMayNotBeTheLast) {
    FileWatch watch;
    watch.know({{"a.gltf", "a.bin"}, {kOld, kOld}});
    EXPECT_EQ(FileChange::None, watch.look({.times = {kOld, kNew}, .finished = true}, kStart));
    EXPECT_EQ(FileChange::None, watch.look({.times = {kNew, kNew}, .finished = true}, kStart + 100ms));
    EXPECT_EQ(FileChange::Settled, watch.look({.times = {kNew, kNew}}, kStart + 600ms));
}

TEST(FileNews, TellsOfTheFilesThatItFollows) {
    const TemporaryFolder folder;
    const std::string path = folder.path("a.glb"), other = folder.path("b.glb");
    std::binary_semaphore woken(0);
    FileNews news([&] { woken.release(); });
    news.follow({path});
    std::ofstream(other) << "another file";
    std::ofstream(path) << "written";
    woken.acquire();
    EXPECT_TRUE(news.take());
    EXPECT_FALSE(news.take()) << "once";
    std::filesystem::rename(other, path);
    woken.acquire();
    EXPECT_TRUE(news.take()) << "an exporter's new file takes its place";

    news.follow({other});
    std::ofstream(path) << "nobody follows it any more";
    std::ofstream(other) << "written";
    woken.acquire();
    EXPECT_TRUE(news.take());
    news.follow({});
    std::ofstream(other) << "neither this";
    EXPECT_FALSE(news.take());
    news.follow({folder.path("no such folder/a.glb")});
    EXPECT_FALSE(news.take());
}

TEST(FileWatch, AGlbIsWholeOnceItHasTheBytesOfItsHeader) {
    const TemporaryFolder folder;
    const std::string path = folder.path("a.glb");
    EXPECT_FALSE((FileSet{.paths = {path}, .times = {}}.isWhole())) << "there is none";
    const std::string bytes("glTF\x02\0\0\0\x14\0\0\0{}  {}  ", 20);
    for (size_t size = 0; size <= bytes.size(); ++size) {
        std::ofstream(path, std::ios::binary) << bytes.substr(0, size);
        EXPECT_EQ((FileSet{.paths = {path}, .times = {}}.isWhole()), size == bytes.size()) << size;
    }
    EXPECT_FALSE((FileSet{.paths = {path, folder.path("b.bin")}, .times = {}}.isWhole()));
    std::ofstream(path) << "{\"asset\": {\"version\": \"2.0\"}}";
    EXPECT_FALSE((FileSet{.paths = {path}, .times = {}}.isWhole())) << "JSON does not tell its length";
}

TEST(FileWatch, AFileThatIsGoneIsNoOtherFile) {
    FileWatch watch;
    watch.know({{"a.glb"}, {kOld}});
    EXPECT_FALSE(lookLater(watch, {FileTime()}));
    EXPECT_FALSE(lookLater(watch, {FileTime()}));
    EXPECT_FALSE(watch.isKnown({{"a.glb"}, {FileTime()}}));
    EXPECT_FALSE(lookLater(watch, {kNew}));
    EXPECT_TRUE(lookLater(watch, {kNew})) << "it is back, and another one";
}

TEST(FileWatch, AFileBesideTheSceneCountsAsTheSceneDoes) {
    FileWatch watch;
    watch.know({{"a.obj", "a.mtl"}, {kOld, kOld}});
    EXPECT_FALSE(lookLater(watch, {kOld, kNew})) << "its writer may not be done";
    EXPECT_TRUE(lookLater(watch, {kOld, kNew}));
    EXPECT_FALSE(watch.isKnown({{"a.obj", "a.mtl"}, {kOld, kNew}}));
    EXPECT_FALSE(lookLater(watch, {kOld, FileTime()}));
    EXPECT_TRUE(lookLater(watch, {kOld, FileTime()})) << "what is gone is told anew, too";
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
