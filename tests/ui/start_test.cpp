// The viewer before there is a scene, and where one cannot be opened.
#include "tests/text.h"
#include "tests/ui/file_drop.h"
#include "tests/ui/glb_json.h"
#include "tests/ui/viewer_fixture.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>

namespace relume {
namespace {

namespace fs = std::filesystem;

class ViewerStart : public ViewerTest {
protected:
    void rememberRecent(const std::vector<std::string>& recent) {
        fs::create_directories(home_.path("config/relume"));
        std::ofstream(home_.path("config/relume/preferences.json"))
            << nlohmann::json{{"window", {{"width", kWidth}, {"height", kHeight}}}, {"recent", recent}};
    }
    std::string damagedFile() {
        const std::string path = home_.path("damaged.glb");
        std::ofstream(path) << "this is no glTF";
        return path;
    }
    /// Clicks a control and expects that something comes of it.
    void clickAndExpect(ViewerProcess& viewer, const std::string& name, const std::string& said) {
        const Place place = placeOf(viewer, name);
        viewer.mark();
        viewer.click(place.first, place.second);
        EXPECT_TRUE(viewer.shows(said, 60)) << name << ": " << viewer.output();
    }
    void pressAndExpect(ViewerProcess& viewer, const std::string& key, const std::string& said) {
        viewer.mark();
        viewer.keys({key});
        EXPECT_TRUE(viewer.shows(said, 60)) << key << ": " << viewer.output();
    }
};

TEST_F(ViewerStart, TheStartPageOpensRecentFilesAndScenesThatShip) {
    const std::string level = home_.path("level.glb"), gone = home_.path("gone.glb");
    fs::copy_file(kScenes + "cornell_small.glb", level);
    rememberRecent({gone, level});
    auto viewer = open({"view"});
    ASSERT_TRUE(viewer->says("middle: start page")) << viewer->output();
    ASSERT_TRUE(viewer->shows("recent: 2 files, 1 gone")) << viewer->output();
    EXPECT_TRUE(item(*viewer, "Start/Recent/level.glb")) << viewer->output();
    EXPECT_TRUE(item(*viewer, "Start/Recent/gone.glb (gone)")) << viewer->output();
    EXPECT_GT(mean(screenshot(*viewer, "shift+F12")), 0.01) << "the page is black";

    clickAndExpect(*viewer, "Start/Recent/Forget gone.glb", "forgot: " + gone);
    clickAndExpect(*viewer, "Start/Scenes/cornell_small", "scene: ");
    EXPECT_TRUE(viewer->says("middle: scene")) << viewer->output();
    // It comes over the scene, and goes.
    pressAndExpect(*viewer, "ctrl+n", "middle: start page");
    pressAndExpect(*viewer, "Escape", "middle: scene");
    pressAndExpect(*viewer, "ctrl+n", "middle: start page");
    clickAndExpect(*viewer, "Start/Recent/level.glb", "scene: " + level);
    quit(*viewer);

    viewer = open({"view"});
    ASSERT_TRUE(viewer->shows("recent: 2 files, 0 gone")) << "the file was forgotten: " << viewer->output();
    // The keyboard begins at the newest file, which Enter opens; an arrow key shows where it is, or leaves
    // it.
    viewer->keys({"Down"});
    viewer->settle();
    if (viewer->focus() != "Start/Recent/level.glb") {
        viewer->keys({"Up"});
        viewer->settle();
    }
    ASSERT_EQ(viewer->focus(), "Start/Recent/level.glb") << viewer->output();
    pressAndExpect(*viewer, "Return", "scene: " + level);
    quit(*viewer);
}

TEST_F(ViewerStart, WhatCannotBeOpenedIsToldInTheMiddleAndTheSceneStays) {
    auto viewer = openConverged();
    const FloatImage before = screenshot(*viewer), beforeWithPanels = screenshot(*viewer, "shift+F12");
    viewer->mark();
    ASSERT_TRUE(dropFile(display_->name(), viewer->windowId(), damagedFile()));
    ASSERT_TRUE(viewer->shows("middle: failure over scene")) << viewer->output();
    EXPECT_LT(difference(before, screenshot(*viewer)), 0.002) << "the scene is as it was";
    EXPECT_GT(difference(beforeWithPanels, screenshot(*viewer, "shift+F12")), 0.002)
        << "the message is over it";

    clickAndExpect(*viewer, "Middle/Copy the message", "copied: " + home_.path("damaged.glb") + ": ");
    clickAndExpect(*viewer, "Middle/Choose another file (Ctrl+O)", "action: Open scene");
    pressAndExpect(*viewer, "Escape", "action: Close");
    EXPECT_EQ(viewer->output().rfind("middle: failure"), viewer->output().rfind("middle: "))
        << "Esc closed the dialog, which is in front of the message";
    clickAndExpect(*viewer, "Middle/Recent files (Ctrl+N)", "middle: start page");
    pressAndExpect(*viewer, "Escape", "middle: scene");
    ASSERT_TRUE(dropFile(display_->name(), viewer->windowId(), home_.path("nosuchfile.glb")));
    ASSERT_TRUE(viewer->shows("middle: failure over scene")) << viewer->output();
    clickAndExpect(*viewer, "Middle/Close (Esc)", "middle: scene");
    EXPECT_LT(difference(before, screenshot(*viewer)), 0.002);
    quit(*viewer);
}

TEST_F(ViewerStart, ADamagedFirstFileLeavesTheStartPage) {
    auto viewer = open({damagedFile()});
    ASSERT_TRUE(viewer->shows("middle: failure over start page")) << viewer->output();
    // Tab goes through the buttons of the message, and Enter presses them.
    viewer->keys({"Tab"});
    viewer->settle();
    pressAndExpect(*viewer, "Return", "action: Open scene");
    pressAndExpect(*viewer, "Escape", "action: Close");
    viewer->keys({"shift+Tab", "shift+Tab"});
    viewer->settle();
    pressAndExpect(*viewer, "Return", "copied: ");
    pressAndExpect(*viewer, "Escape", "middle: start page");
    quit(*viewer);
}

TEST_F(ViewerStart, AMenuChoosesAmongTheScenesOfAFile) {
    const std::string path = home_.path("two.glb");
    std::ofstream(path, std::ios::binary)
        << withJson(bytesOf(kScenes + "cornell_small.glb"), [](nlohmann::json& document) {
               nlohmann::json day = document["scenes"][0], night = day;
               day["name"] = "day";
               night["name"] = "night";
               document["scenes"] = {day, night};
           });
    auto viewer = open({path});
    ASSERT_TRUE(viewer->shows("middle: scene", 60)) << viewer->output();
    for (const char* name : {"Menu/File", "File/Scene"}) {
        const Place place = placeOf(*viewer, name);
        viewer->click(place.first, place.second);
        viewer->settle();
    }
    clickAndExpect(*viewer, "File/Scene/night", "scene: " + path);
    EXPECT_TRUE(viewer->says("choose: night")) << viewer->output();
    quit(*viewer);
}

TEST_F(ViewerStart, AMenuExportsTheLevelForAnEngine) {
    const std::string path = home_.path("room.glb"), folder = home_.path("room_three");
    std::filesystem::copy_file(kScenes + "cornell_small.glb", path);
    auto viewer = open({path});
    ASSERT_TRUE(viewer->shows("bake: done", 240)) << viewer->output();
    for (const char* name : {"Menu/File", "File/Export for", "File/Export for/three"}) {
        const Place place = placeOf(*viewer, name);
        viewer->click(place.first, place.second);
        viewer->settle();
    }
    viewer->mark();
    viewer->keys({"Return"}); // the folder that it offers, beside the scene
    EXPECT_TRUE(viewer->says("export: " + folder)) << viewer->output();
    ASSERT_TRUE(viewer->says("wrote " + folder, 60)) << viewer->output();
    for (const char* file : {"scene.glb", "lightmap.ktx2", "lightmap.exr", "index.html", "loader.js"})
        EXPECT_TRUE(std::filesystem::exists(folder + "/" + file)) << file;
    quit(*viewer);
}

TEST_F(ViewerStart, AMenuExportsAPageWithTheMixBoard) {
    const std::string path = home_.path("room.glb"), folder = home_.path("room_page");
    std::filesystem::copy_file(kScenes + "cornell_small.glb", path);
    auto viewer = open({path, "--layer-memory", "1G"});
    ASSERT_TRUE(viewer->shows("bake: done", 240)) << viewer->output();
    for (const char* name : {"Menu/File", "File/Export for", "File/Export for/web page"}) {
        const Place place = placeOf(*viewer, name);
        viewer->click(place.first, place.second);
        viewer->settle();
    }
    viewer->mark();
    viewer->keys({"Return"}); // the folder that it offers, beside the scene
    EXPECT_TRUE(viewer->says("export: " + folder)) << viewer->output();
    ASSERT_TRUE(viewer->says("wrote " + folder, 60)) << viewer->output();
    for (const char* file : {"index.html", "scene.js", "main.js"})
        EXPECT_TRUE(std::filesystem::exists(folder + "/" + file)) << file;
    quit(*viewer);
}

TEST_F(ViewerStart, AViewerThatIsKilledKeepsItsRecentFiles) {
    const std::string level = home_.path("level.glb");
    fs::copy_file(kScenes + "cornell_small.glb", level);
    auto viewer = open({level});
    ASSERT_TRUE(viewer->says("scene: " + level, 60)) << viewer->output();
    viewer.reset(); // it still runs, and is ended by force
    viewer = open({"view"});
    ASSERT_TRUE(viewer->shows("recent: 1 files, 0 gone")) << viewer->output();
    EXPECT_TRUE(item(*viewer, "Start/Recent/level.glb")) << viewer->output();
    quit(*viewer);
}

TEST_F(ViewerStart, AloneItOpensWhereThereIsADisplay) {
    ViewerProcess viewer({.display = display_->name(), .home = home_.path(""), .arguments = {}});
    ASSERT_TRUE(viewer.window()) << viewer.output();
    viewer.keys({"ctrl+q"});
    EXPECT_EQ(viewer.ended(10), 0) << viewer.output();
}

TEST(ViewerWithout, ADisplayItShowsTheHelpWhereItIsAlone) {
    const TemporaryFolder home;
    ViewerProcess viewer({.display = ":nosuchdisplay", .home = home.path(""), .arguments = {}});
    EXPECT_EQ(viewer.ended(20), 2);
    EXPECT_TRUE(viewer.says("no window", 1)) << viewer.output();
    EXPECT_TRUE(viewer.says("A subcommand is required", 1)) << viewer.output();
}

} // namespace
} // namespace relume
