// These tests say what the start page lists, and what a message about a file says.
#include "app/viewer/state/failure_text.h"
#include "app/viewer/state/file_choices.h"
#include "app/viewer/state/recent_files.h"
#include "app/viewer/state/shipped_scenes.h"
#include "tests/temporary_folder.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace relume {
namespace {

namespace fs = std::filesystem;

FailureText textOf(const std::string& path, const std::string& message) {
    return failureText({path, message});
}

TEST(FailureText, HasFileThingAndMend) {
    const FailureText text =
        textOf("/levels/room.glb", "/levels/room.glb: mesh 'Wall' has no UVs: pass --unwrap");
    EXPECT_EQ(text.name, "room.glb");
    EXPECT_EQ(text.folder, "/levels");
    EXPECT_EQ(text.thing, "mesh 'Wall' has no UVs");
    EXPECT_EQ(text.mend, "pass --unwrap");
}

TEST(FailureText, TheMendIsTheLastPart) {
    const FailureText text = textOf("a: b.glb", "a: b.glb: nodes[3]: it is its own child: export it again");
    EXPECT_EQ(text.name, "a: b.glb") << "a name may have a colon";
    EXPECT_EQ(text.thing, "nodes[3]: it is its own child");
    EXPECT_EQ(text.mend, "export it again");
}

TEST(FailureText, ASceneThatCannotBeDrawnIsNoFileThatCannotBeOpened) {
    const std::string message = "/levels/big.glb: cannot be drawn: texture 'wood' (9 x 9): no memory";
    const FailureText text = failureText({"/levels/big.glb", message, true});
    EXPECT_EQ(text.title, "This scene cannot be drawn");
    EXPECT_EQ(text.name, "big.glb");
    EXPECT_EQ(text.thing, "cannot be drawn: texture 'wood' (9 x 9): no memory") << "all that OpenGL says";
    EXPECT_NE(text.mend.find("baked and exported all the same"), std::string::npos) << text.mend;
    EXPECT_EQ(textOf("/levels/big.glb", message).title, "This file cannot be opened");
}

TEST(FailureText, WhatIsMissingIsFilledIn) {
    EXPECT_EQ(textOf("x.glb", "x.glb: does not fit in memory").thing, "does not fit in memory");
    EXPECT_EQ(textOf("x.glb", "x.glb: does not fit in memory").mend, "choose another file");
    EXPECT_EQ(textOf("x.glb", "").thing, "the file cannot be opened");
    EXPECT_EQ(textOf("/levels/", "/levels/: is a folder: name a file").name, "/levels/");
}

TEST(FailureText, AnotherFileThatIsToBlameKeepsItsName) {
    const FailureText text = textOf("room.gltf", "wood.png: is missing: put it beside the scene");
    EXPECT_EQ(text.name, "room.gltf");
    EXPECT_EQ(text.thing, "wood.png: is missing");
}

TEST(FailureText, OfALongPathTheEndIsShown) {
    const auto fits = [](size_t most) {
        return [most](const std::string& text) { return text.size() <= most; };
    };
    EXPECT_EQ(endOf("/a/b/c.glb", fits(10)), "/a/b/c.glb");
    EXPECT_EQ(endOf("/a/b/c.glb", fits(9)), ".../c.glb");
    EXPECT_EQ(endOf("/a/b/c.glb", fits(4)), "...b");
    EXPECT_EQ(endOf("/a/b/c.glb", fits(1)), "...") << "there is no room at all";
    EXPECT_EQ(endOf("", fits(0)), "");
    const std::string umlauts = "\u00e4\u00f6\u00fc"; // two bytes each
    EXPECT_EQ(endOf(umlauts, fits(5)), "...\u00fc");
    EXPECT_EQ(endOf(umlauts, fits(4)), "...") << "no half of a letter";
}

TEST(RecentFiles, ThoseThatAreGoneAreMarked) {
    const TemporaryFolder folder;
    const std::string there = folder.path("there.glb"), gone = folder.path("gone.glb"),
                      dir = folder.path("dir.glb");
    std::ofstream(there) << "x";
    fs::create_directory(dir);
    const std::vector<std::string> recent = {gone, there, dir};
    EXPECT_EQ(goneFiles(recent), (std::set<std::string>{gone, dir})) << "a folder is no file";
    const std::vector<RecentFile> files = recentFiles(recent, goneFiles(recent), "");
    ASSERT_EQ(files.size(), 3u);
    EXPECT_EQ(files[0], (RecentFile{gone, "gone.glb", folder.path(), true})) << "the newest stays first";
    EXPECT_EQ(files[1], (RecentFile{there, "there.glb", folder.path(), false}));
    fs::remove(there);
    EXPECT_TRUE(goneFiles(recent).contains(there));
}

TEST(RecentFiles, FoldersAreShownFromHome) {
    const auto folderOf = [](const std::string& path, const std::string& home) {
        return recentFiles({path}, {}, home).front().folder;
    };
    EXPECT_EQ(folderOf("/home/ada/levels/x.glb", "/home/ada"), "~/levels");
    EXPECT_EQ(folderOf("/home/ada/x.glb", "/home/ada"), "~");
    EXPECT_EQ(folderOf("/home/adam/x.glb", "/home/ada"), "/home/adam") << "somebody else's";
    EXPECT_EQ(folderOf("/srv/x.glb", "/"), "/srv");
    EXPECT_EQ(folderOf("/srv/x.glb", ""), "/srv");
}

class ShippedScenes : public testing::Test {
protected:
    void file(const std::string& name) const {
        const fs::path path = folder_.path(name);
        fs::create_directories(path.parent_path());
        std::ofstream(path) << "x";
    }
    std::string path(const std::string& name) const { return folder_.path(name); }
    const TemporaryFolder folder_;
};

TEST_F(ShippedScenes, AreBesideTheInstalledProgramFirst) {
    file("usr/share/relume/scenes/room.glb");
    file("assets/scenes/room.glb");
    EXPECT_EQ(shippedFolder(path("usr/bin/relume"), path("")), path("usr/share/relume/scenes"));
    EXPECT_EQ(shippedFolder(path("usr/lib/relume"), path("")), path("usr/share/relume/scenes"));
}

TEST_F(ShippedScenes, AreAboveTheBuildFolderElse) {
    file("assets/scenes/room.glb");
    fs::create_directories(path("build/release/app"));
    EXPECT_EQ(shippedFolder(path("build/release/app/relume"), ""), path("assets/scenes"));
    EXPECT_EQ(shippedFolder("/nowhere/at/all/relume", path("")), path("") + "assets/scenes");
    EXPECT_EQ(shippedFolder("/nowhere/at/all/relume", ""), "");
    EXPECT_EQ(shippedFolder("", ""), "") << "the program's path is not known";
}

TEST_F(ShippedScenes, AreListedByNameWithTheirPictures) {
    for (const char* name : {"assets/scenes/b.glb", "assets/scenes/a.glb", "assets/scenes/README.md",
                             "assets/scenes/c.glb", "assets/scenes/c.png", "assets/pictures/scenes/b.png"})
        file(name);
    const std::vector<ShippedScene> scenes = shippedScenes(path("assets/scenes"));
    ASSERT_EQ(scenes.size(), 3u);
    EXPECT_EQ(scenes[0],
              (ShippedScene{"a", path("assets/scenes/a.glb"), path("assets/pictures/scenes/a.png")}))
        << "it has none, and is listed all the same";
    EXPECT_EQ(scenes[1].picture, path("assets/pictures/scenes/b.png"));
    EXPECT_EQ(scenes[2].picture, path("assets/scenes/c.png")) << "as they are installed";
    EXPECT_TRUE(shippedScenes("").empty());
    EXPECT_TRUE(shippedScenes(path("nosuchfolder")).empty());
}

TEST_F(ShippedScenes, ThoseOfThisTreeAreFound) {
    const std::string folder = shippedFolder(programPath(), RELUME_SOURCE_DIR);
    const std::vector<ShippedScene> scenes = shippedScenes(folder);
    EXPECT_GE(scenes.size(), 7u);
    for (const ShippedScene& scene : scenes)
        EXPECT_TRUE(fs::is_regular_file(scene.picture)) << scene.name << " has no small picture";
}

std::vector<std::string> labelsOf(const std::vector<FileChoice>& choices) {
    std::vector<std::string> labels;
    for (const FileChoice& choice : choices)
        labels.push_back(choice.label + (choice.chosen ? " *" : ""));
    return labels;
}

using Labels = std::vector<std::string>;

TEST(FileChoices, AreOfferedWhereThereIsAChoice) {
    EXPECT_TRUE(sceneChoices({}, -1, {}).empty());
    EXPECT_TRUE(sceneChoices({"only"}, 0, {}).empty());
    EXPECT_TRUE(variantChoices({}, {}).empty());
    EXPECT_EQ(labelsOf(sceneChoices({"day", "night"}, 1, {})), (Labels{"day", "night *"}));
    EXPECT_EQ(labelsOf(sceneChoices({"day", "night"}, -1, {})), (Labels{"day", "night"}));
    EXPECT_EQ(labelsOf(variantChoices({"red"}, {})), (Labels{"The file's own materials *", "red"}));
    EXPECT_EQ(labelsOf(variantChoices({"red"}, {.variant = "red"})),
              (Labels{"The file's own materials", "red *"}));
}

TEST(FileChoices, KeepWhatElseWasChosen) {
    const GltfChoice now{.scene = "day", .variant = "red", .time = 2.0};
    EXPECT_EQ(sceneChoices({"day", "night"}, 0, now)[1].choice,
              (GltfChoice{.scene = "night", .variant = "red", .time = 2.0}));
    EXPECT_EQ(variantChoices({"red"}, now)[0].choice, (GltfChoice{.scene = "day", .time = 2.0}));
}

TEST(FileChoices, ScenesOfOneNameGoByNumber) {
    const std::vector<FileChoice> choices = sceneChoices({"hall", "hall"}, 1, {});
    ASSERT_EQ(choices.size(), 2u);
    EXPECT_EQ(choices[0].choice.scene, "hall");
    EXPECT_EQ(choices[1].choice.scene, "1");
    EXPECT_TRUE(choices[1].chosen);
}

} // namespace
} // namespace relume
