#include "app/viewer/state/preferences.h"
#include "app/viewer/window/path_completion.h"
#include "assets/base/error.h"
#include "tests/temporary_folder.h"
#include "tests/text.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include <sys/stat.h>

namespace relume {
namespace {

namespace fs = std::filesystem;

class PreferencesFile : public testing::Test {
protected:
    std::string path(const std::string& name) const { return folder_.path(name); }
    void write(const std::string& name, const std::string& text) const { std::ofstream(path(name)) << text; }
    const TemporaryFolder folder_;
};

// A window that is made 2.5 times as large by its monitor's scale grew by that at each start.
TEST(Preferences, AWindowIsRememberedWithoutItsMonitorsScale) {
    EXPECT_EQ(rememberedWindow({3200, 2000}, 2.5f), glm::uvec2(1280, 800));
    EXPECT_EQ(rememberedWindow({1280, 800}, 1.0f), glm::uvec2(1280, 800));
    EXPECT_EQ(rememberedWindow({200, 100000}, 1.0f), glm::uvec2(kLeastWindowEdge, kMostWindowEdge))
        << "what the file may hold";
    EXPECT_EQ(rememberedWindow({800, 600}, 0.0f), glm::uvec2(kLeastWindowEdge));
}

TEST_F(PreferencesFile, ComesBackAsItWas) {
    Preferences before;
    before.width = 1000;
    before.height = 700;
    before.panelWidth = 250;
    before.uiScale = 1.5f;
    before.vsync = false;
    before.caption = true;
    before.samples = 8;
    before.filter = LightmapFilter::Bicubic;
    before.tone = ToneMap::Aces;
    before.captureFolder = "shots";
    before.recent = {"one.glb", "two.glb"};
    Bookmark mark{"corner", {}};
    mark.camera.eye = {1, 2, 3};
    mark.camera.yfov = 0.5f;
    before.bookmarks["one.glb"] = {mark};
    writePreferences(path("new/folder/p.json"), before);
    const Preferences after = readPreferences(path("new/folder/p.json"));
    EXPECT_EQ(after.width, 1000u);
    EXPECT_EQ(after.height, 700u);
    EXPECT_EQ(after.panelWidth, 250);
    EXPECT_EQ(after.uiScale, 1.5f);
    EXPECT_FALSE(after.vsync);
    EXPECT_TRUE(after.caption);
    EXPECT_EQ(after.samples, 8u);
    EXPECT_EQ(after.filter, LightmapFilter::Bicubic);
    EXPECT_EQ(after.tone, ToneMap::Aces);
    EXPECT_EQ(after.captureFolder, "shots");
    EXPECT_EQ(after.recent, before.recent);
    ASSERT_EQ(after.bookmarks.at("one.glb").size(), 1u);
    EXPECT_EQ(after.bookmarks.at("one.glb").front().name, "corner");
    EXPECT_EQ(after.bookmarks.at("one.glb").front().camera.eye, glm::vec3(1, 2, 3));
    EXPECT_EQ(after.bookmarks.at("one.glb").front().camera.yfov, 0.5f);
}

TEST(Preferences, BookmarksOfASceneHaveNamesOfTheirOwn) {
    Preferences preferences;
    preferences.bookmarks["one.glb"] = {{"corner", {}}, {"bookmark 3", {}}};
    EXPECT_EQ(preferences.addBookmark("one.glb", {}), "bookmark 4") << "3 is taken";
    EXPECT_EQ(preferences.addBookmark("two.glb", {}), "bookmark 1");
    EXPECT_EQ(preferences.bookmarks["one.glb"].size(), 3u);
}

// JSON holds only UTF-8, which names of files need not be.
TEST_F(PreferencesFile, NamesThatAreNoUtf8ComeBack) {
    Preferences before;
    before.captureFolder = "caf\xe9/shots";
    before.recent = {"/home/caf\xe9/a b%20.glb", "/home/caf\xc3\xa9/plain%20.glb"};
    before.bookmarks[before.recent[0]] = {{"corner", {}}};
    before.bookmarks[before.recent[0]][0].camera.eye = {1, 2, 3};
    writePreferences(path("p.json"), before);
    const Preferences after = readPreferences(path("p.json"));
    EXPECT_EQ(after.captureFolder, before.captureFolder);
    EXPECT_EQ(after.recent, before.recent);
    EXPECT_EQ(after.bookmarks.count(before.recent[0]), 1u);
}

TEST_F(PreferencesFile, ReadAndWrittenAgainABookmarkKeepsItsDigits) {
    Preferences preferences;
    Bookmark mark{"corner", {}};
    mark.camera.up = {8, 1, 0}; // as somebody may type it; it is made one of unit length
    preferences.bookmarks["scene.glb"] = {mark};
    writePreferences(path("typed"), preferences);
    writePreferences(path("once"), readPreferences(path("typed")));
    writePreferences(path("twice"), readPreferences(path("once")));
    EXPECT_EQ(bytesOf(path("once")), bytesOf(path("twice")));
}

TEST_F(PreferencesFile, APipeIsNotWaitedFor) {
    ASSERT_EQ(mkfifo(path("pipe").c_str(), 0600), 0);
    EXPECT_EQ(readPreferences(path("pipe")).width, Preferences().width);
    EXPECT_EQ(readPreferences(folder_.path()).width, Preferences().width);
}

TEST_F(PreferencesFile, BrokenOnesKeepTheDefaults) {
    const Preferences defaults;
    for (const char* text : {"", "{", "[]", "null", "17", "{\"window\": 3}", "\xff\xfe"}) {
        write("broken.json", text);
        const Preferences read = readPreferences(path("broken.json"));
        EXPECT_EQ(read.width, defaults.width) << text;
        EXPECT_TRUE(read.recent.empty()) << text;
    }
    EXPECT_EQ(readPreferences(path("missing.json")).width, defaults.width);
}

TEST_F(PreferencesFile, WhatIsWrongGoesAloneAndTheRestStays) {
    write("p.json",
          R"({"window": {"width": -5, "height": 900}, "uiScale": "big", "vsync": 1, "filter": "none",
        "tone": "aces", "samples": -1, "recent": ["a.glb", 3, "b.glb"],
        "bookmarks": {"a.glb": [{"name": "flat", "eye": [0,0,0], "target": [0,0,0]}, 7,
                                {"name": "good", "eye": [0,0,5], "target": [0,0,0], "up": [0,2,0]}]}})");
    const Preferences read = readPreferences(path("p.json"));
    EXPECT_EQ(read.width, Preferences().width);
    EXPECT_EQ(read.height, 900u);
    EXPECT_EQ(read.uiScale, 1.0f);
    EXPECT_TRUE(read.vsync);
    EXPECT_EQ(read.filter, LightmapFilter::Bilinear);
    EXPECT_EQ(read.tone, ToneMap::Aces);
    EXPECT_FALSE(read.samples);
    EXPECT_EQ(read.recent, (std::vector<std::string>{"a.glb", "b.glb"}));
    ASSERT_EQ(read.bookmarks.at("a.glb").size(), 1u);
    EXPECT_EQ(read.bookmarks.at("a.glb").front().name, "good");
    EXPECT_EQ(read.bookmarks.at("a.glb").front().camera.up, glm::vec3(0, 1, 0));
}

TEST_F(PreferencesFile, AFolderThatCannotBeIsAnError) {
    write("file", "x");
    EXPECT_THROW(writePreferences(path("file/below/p.json"), {}), Error);
}

TEST(Preferences, RecentScenesAreNewestFirstAndOnce) {
    Preferences preferences;
    for (int i = 0; i < 20; ++i)
        preferences.addRecent("/scenes/" + std::to_string(i) + ".glb");
    EXPECT_EQ(preferences.recent.size(), Preferences::kMostRecent);
    preferences.addRecent("/scenes/x/../15.glb");
    EXPECT_EQ(preferences.recent.front(), "/scenes/15.glb");
    EXPECT_EQ(std::count(preferences.recent.begin(), preferences.recent.end(), "/scenes/15.glb"), 1);
}

TEST_F(PreferencesFile, CompletionGoesAsFarAsThereIsOneWay) {
    write("room_a.glb", "");
    write("room_b.GLB", "");
    write("room.txt", "");
    write(".room_hidden.glb", "");
    fs::create_directory(path("models"));
    const std::vector<std::string> endings = {".glb"};
    const PathCompletion rooms = completePath(path("r"), endings);
    EXPECT_EQ(rooms.text, path("room_"));
    EXPECT_EQ(rooms.matches, (std::vector<std::string>{path("room_a.glb"), path("room_b.GLB")}));
    EXPECT_EQ(completePath(path("m"), endings).text, path("models/"));
    EXPECT_EQ(completePath(path(""), endings).matches.size(), 3u);
    const PathCompletion none = completePath(path("zzz"), endings);
    EXPECT_TRUE(none.matches.empty());
    EXPECT_EQ(none.text, path("zzz"));
    EXPECT_EQ(completePath(path(".r"), endings).matches.size(), 1u);
    EXPECT_TRUE(completePath("/no/such/folder/x", endings).matches.empty());
}

TEST_F(PreferencesFile, FreeNamesExistNowhere) {
    EXPECT_EQ(freePath(path("map.exr")), path("map.exr"));
    write("map.exr", "");
    EXPECT_EQ(freePath(path("map.exr")), path("map_2.exr"));
    write("map_2.exr", "");
    EXPECT_EQ(freePath(path("map.exr")), path("map_3.exr"));
    fs::create_symlink(path("nowhere"), path("map_3.exr")); // would be followed
    EXPECT_EQ(freePath(path("map.exr")), path("map_4.exr"));
}

TEST(Home, IsExpandedForOneself) {
    const char* home = std::getenv("HOME");
    if (home == nullptr) GTEST_SKIP() << "HOME is not set";
    EXPECT_EQ(expandHome("~/a"), std::string(home) + "/a");
    EXPECT_EQ(expandHome("~other/a"), "~other/a");
    EXPECT_EQ(expandHome("a/~"), "a/~");
}

} // namespace
} // namespace relume
