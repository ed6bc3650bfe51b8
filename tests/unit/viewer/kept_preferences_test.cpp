// Preferences of viewers that run at once, and of one that is killed.
#include "app/viewer/state/kept_preferences.h"
#include "tests/temporary_folder.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace relume {
namespace {

namespace fs = std::filesystem;
using Paths = std::vector<std::string>;

Preferences withRecent(const Paths& recent) {
    Preferences preferences;
    preferences.recent = recent;
    return preferences;
}

Paths mergedRecent(const Paths& before, const Paths& own, const Paths& theirs) {
    return mergePreferences(withRecent(before), withRecent(own), withRecent(theirs)).recent;
}

TEST(MergedPreferences, HoldRecentScenesOfBothViewersTheOwnNewOneFirst) {
    EXPECT_EQ(mergedRecent({"/a"}, {"/b", "/a"}, {"/c", "/a"}), (Paths{"/b", "/c", "/a"}));
    EXPECT_EQ(mergedRecent({"/a", "/b"}, {"/b", "/a"}, {"/c", "/a", "/b"}), (Paths{"/b", "/c", "/a"}))
        << "one that was opened again comes first";
    EXPECT_EQ(mergedRecent({"/a"}, {"/a"}, {"/c", "/a"}), (Paths{"/c", "/a"})) << "nothing was opened here";
}

TEST(MergedPreferences, ForgetWhatWasForgottenHereAndNoMore) {
    EXPECT_EQ(mergedRecent({"/a", "/b"}, {"/b"}, {"/c", "/a", "/b"}), (Paths{"/c", "/b"}));
    EXPECT_EQ(mergedRecent({"/a", "/b"}, {"/a", "/b"}, {"/b"}), (Paths{"/b"})) << "the other forgot it";
}

TEST(MergedPreferences, AFullListDropsItsOldestAndForgetsNothing) {
    Preferences before;
    for (size_t i = 0; i < Preferences::kMostRecent; ++i)
        before.pushRecent("/" + std::to_string(i));
    Preferences own = before;
    own.pushRecent("/new"); // "/0" falls out
    const Preferences theirs = withRecent({"/0"});
    EXPECT_EQ(mergePreferences(before, own, theirs).recent, (Paths{"/new", "/0"}));
    EXPECT_EQ(mergePreferences(before, own, before).recent, own.recent);
}

TEST(MergedPreferences, KeepBookmarksOfBothAndTheOwnSettings) {
    Preferences before, own, theirs;
    own.uiScale = 2;
    before.bookmarks["/a"] = own.bookmarks["/a"] = theirs.bookmarks["/a"] = {{"kept", {}}, {"gone", {}}};
    own.bookmarks["/a"].pop_back();
    own.bookmarks["/a"].push_back({"bookmark 2", {}});
    own.bookmarks["/a"].back().camera.eye = {1, 2, 3};
    theirs.bookmarks["/a"].push_back({"bookmark 2", {}});
    theirs.bookmarks["/b"] = {{"theirs", {}}};
    const Preferences merged = mergePreferences(before, own, theirs);
    EXPECT_EQ(merged.uiScale, 2);
    const std::vector<Bookmark>& marks = merged.bookmarks.at("/a");
    ASSERT_EQ(marks.size(), 3u);
    EXPECT_EQ(marks[0].name, "kept");
    EXPECT_EQ(marks[1].name, "bookmark 2");
    EXPECT_EQ(marks[2].name, "bookmark 3") << "the other's name is taken";
    EXPECT_EQ(marks[2].camera.eye, glm::vec3(1, 2, 3));
    EXPECT_EQ(merged.bookmarks.count("/b"), 1u);
}

class KeptPreferencesFile : public testing::Test {
protected:
    static void open(KeptPreferences& viewer, const std::string& scene) {
        viewer.values().addRecent(scene);
        viewer.save();
    }
    const TemporaryFolder folder_;
    const std::string path_ = folder_.path("config/p.json");
};

TEST_F(KeptPreferencesFile, HoldsASceneFromWhenItWasOpened) {
    KeptPreferences viewer(path_);
    open(viewer, "/a.glb");
    EXPECT_EQ(readPreferences(path_).recent, (Paths{"/a.glb"})) << "the viewer still runs";
}

TEST_F(KeptPreferencesFile, TwoViewersLoseNothingOfEachOther) {
    KeptPreferences one(path_), two(path_);
    open(one, "/a.glb");
    open(two, "/b.glb");
    EXPECT_EQ(two.values().recent, (Paths{"/b.glb", "/a.glb"}));
    one.values().uiScale = 2;
    one.save(); // it ends
    two.save();
    EXPECT_EQ(readPreferences(path_).recent, (Paths{"/b.glb", "/a.glb"}));
    std::erase(two.values().recent, "/a.glb");
    two.save();
    EXPECT_EQ(readPreferences(path_).recent, (Paths{"/b.glb"}));
}

TEST_F(KeptPreferencesFile, AFileThatIsDamagedMeanwhileTakesNothingAlong) {
    KeptPreferences viewer(path_);
    open(viewer, "/a.glb");
    std::ofstream(path_) << "{ half of it";
    open(viewer, "/b.glb");
    EXPECT_EQ(readPreferences(path_).recent, (Paths{"/b.glb", "/a.glb"}));
}

TEST_F(KeptPreferencesFile, WhereNothingCanBeWrittenTheListIsKeptInMemory) {
    std::ofstream(folder_.path("file")) << "no folder";
    for (const std::string& path : {folder_.path("file/p.json"), std::string()}) {
        KeptPreferences viewer(path);
        open(viewer, "/a.glb");
        EXPECT_EQ(viewer.values().recent, (Paths{"/a.glb"})) << path;
    }
}

TEST_F(KeptPreferencesFile, WhatCouldNotBeWrittenComesWithTheNextSave) {
    KeptPreferences viewer(path_);
    open(viewer, "/a.glb");
    fs::remove(path_);
    fs::create_directory(path_); // no file can take its place
    open(viewer, "/b.glb");
    viewer.values().addBookmark("/b.glb", {});
    viewer.save();
    ASSERT_TRUE(fs::is_directory(path_)) << "it was to fail";
    fs::remove(path_);
    KeptPreferences other(path_);
    open(other, "/c.glb");
    viewer.save();
    EXPECT_EQ(readPreferences(path_).recent, (Paths{"/b.glb", "/c.glb"}));
    EXPECT_EQ(readPreferences(path_).bookmarks.count("/b.glb"), 1u);
    EXPECT_EQ(viewer.values().bookmarks.count("/b.glb"), 1u);
}

// Without the lock, what one writes between another's reading and writing is lost.
TEST_F(KeptPreferencesFile, ManyWritersAtOnceAllGetTheirPlace) {
    constexpr size_t kWriters = 4;
    std::vector<std::thread> writers;
    for (size_t i = 0; i < kWriters; ++i)
        writers.emplace_back([this, i] {
            KeptPreferences viewer(path_);
            open(viewer, "/" + std::to_string(i) + ".glb");
        });
    for (std::thread& writer : writers)
        writer.join();
    const Paths recent = readPreferences(path_).recent;
    EXPECT_EQ(recent.size(), kWriters);
    for (const auto& entry : fs::directory_iterator(folder_.path("config")))
        EXPECT_EQ(entry.path(), path_) << "something was left behind";
}

} // namespace
} // namespace relume
