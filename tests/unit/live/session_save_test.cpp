// This tests the session without a Vulkan device: what is saved, and what is known to be saved.
#include "app/live/session.h"

#include "app/viewer/edits/light_edits.h"
#include "assets/base/error.h"
#include "assets/base/log.h"
#include "assets/gltf/gltf.h"
#include "tests/text.h"
#include "tests/ui/glb_json.h"
#include "tests/unit/session_fixture.h"

#include <gtest/gtest.h>

#include <chrono>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <thread>

namespace relume {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;

/// Saves edits into the scene's file.
class SessionSaveTest : public SessionTest {
protected:
    void change(const std::string& name, const std::function<void(SceneEdits&)>& what) {
        Document next = session_.document();
        what(next.edits);
        session_.edit(name, next);
        session_.endEdit();
    }
    void addLamp(const std::string& name) {
        change("Add", [&](SceneEdits& edits) {
            edits.lights.emplace_back().name = name;
            edits.lights.back().transform[3] = {1, 2, 3, 1};
        });
    }
    bool save(const std::string& path = "") {
        session_.save(path);
        return until([&] { return !session_.saving(); }) && session_.lastError().empty();
    }
    /// Opens a scene whose file another program writes anew, and saves an edit while that is read.
    void saveWhileItIsRead() {
        open();
        session_.watchFile(true);
        writeFile(kScenes + "cornell_small.glb");
        ASSERT_TRUE(until([&] { return session_.loading(); }));
        dim(0.5f);
        session_.endEdit();
        session_.save(); // once the file is read
    }
    static size_t nodesOf(const std::string& path) {
        const std::string bytes = bytesOf(path);
        size_t count = 0;
        for (size_t at = bytes.find("\"light\":"); at != std::string::npos;
             at = bytes.find("\"light\":", at + 1))
            ++count;
        return count;
    }
};

TEST_F(SessionSaveTest, WhatIsEditedIsUnsavedUntilItIsSaved) {
    EXPECT_FALSE(session_.dirty());
    EXPECT_EQ(session_.path(), "");
    session_.save(); // nothing there
    open();
    const std::string before = bytesOf(file());
    EXPECT_FALSE(session_.dirty());
    dim(0.5f);
    session_.endEdit();
    EXPECT_TRUE(session_.dirty());
    session_.undo();
    EXPECT_FALSE(session_.dirty()) << "as the file has it";
    session_.redo();
    ASSERT_TRUE(save());
    EXPECT_FALSE(session_.dirty());
    EXPECT_EQ(session_.saves(), 1u);
    EXPECT_NE(bytesOf(file()), before);
    float saved = 0;
    for (const Material& material : loadGltf(file()).materials)
        saved = std::max(saved, material.emission.r);
    EXPECT_EQ(saved, brightest());
    session_.undo();
    EXPECT_TRUE(session_.dirty()) << "not as the file has it now";
    change("Hide", [](SceneEdits& edits) { edits.placements[0].hidden = true; });
    ASSERT_TRUE(save());
    EXPECT_FALSE(session_.dirty());
    EXPECT_TRUE(loadGltf(file()).instances[0].hidden);
    session_.undo();
    EXPECT_TRUE(session_.dirty()) << "the file hides it";
    ASSERT_TRUE(save());
    EXPECT_EQ(bytesOf(file()), before) << "a value that is edited back is what it was";
}

TEST_F(SessionSaveTest, PreviewLightIsInNoFileUntilItIsKept) {
    Scene dark = loadGltf(kScenes + "cornell_small.glb");
    for (Material& material : dark.materials)
        material.emission = glm::vec3(0.0f);
    dark.lights.clear();
    dark.sky = {};
    saveGlb(dark, file());
    open();
    ASSERT_EQ(session_.document().edits.lights.size(), 1u);
    EXPECT_FALSE(session_.scene()->prepared.madeLight.empty());
    EXPECT_FALSE(session_.dirty());
    change("Strength", [](SceneEdits& edits) { edits.lights[0].intensity *= 2; });
    EXPECT_FALSE(session_.dirty()) << "it is no light of the file";
    addLamp("Own");
    ASSERT_TRUE(save());
    ASSERT_EQ(loadGltf(file()).lights.size(), 1u);
    EXPECT_EQ(loadGltf(file()).lights[0].name, "Own");
    change("Keep", [](SceneEdits& edits) { keepPreview(edits); });
    EXPECT_TRUE(session_.dirty());
    ASSERT_TRUE(save());
    EXPECT_EQ(loadGltf(file()).lights.size(), 2u);
    change("Place", [](SceneEdits& edits) { edits.lights[0].transform[3].x += 0.1f; });
    ASSERT_TRUE(save());
    EXPECT_EQ(loadGltf(file()).lights.size(), 2u) << "each light has its node";
}

// Another program may have moved the file away, and brings it back.
TEST_F(SessionSaveTest, AFileThatIsGoneIsNamedWithWhatHelps) {
    open();
    addLamp("A");
    fs::rename(file(), folder_.path("away.glb"));
    EXPECT_FALSE(save());
    EXPECT_EQ(session_.lastError(),
              file() + ": is gone, so that its edits cannot be saved: put it back and save again");
    session_.clearError();
    EXPECT_FALSE(save(folder_.path("other.glb"))) << "nor as another file";
    EXPECT_FALSE(fs::exists(folder_.path("other.glb")));
    EXPECT_TRUE(session_.dirty());
    session_.clearError();
    fs::rename(folder_.path("away.glb"), file());
    EXPECT_TRUE(save());
    EXPECT_FALSE(session_.dirty());
    EXPECT_EQ(loadGltf(file()).lights.size(), 1u);
}

TEST_F(SessionSaveTest, ALampIsAddedToTheFileOnce) {
    open();
    addLamp("A");
    ASSERT_TRUE(save());
    ASSERT_EQ(loadGltf(file()).lights.size(), 1u);
    addLamp("B");
    change("Move", [](SceneEdits& edits) { edits.lights[0].transform[3].x = 9; });
    ASSERT_TRUE(save());
    const std::string both = bytesOf(file());
    Scene scene = loadGltf(file());
    ASSERT_EQ(scene.lights.size(), 2u);
    EXPECT_EQ(scene.lights[0].name, "A");
    EXPECT_EQ(scene.lights[0].transform[3].x, 9);
    EXPECT_EQ(scene.lights[1].name, "B");
    EXPECT_EQ(nodesOf(file()), 2u);

    change("Delete A", [](SceneEdits& edits) { edits.lights.erase(edits.lights.begin()); });
    ASSERT_TRUE(save());
    scene = loadGltf(file());
    ASSERT_EQ(scene.lights.size(), 1u);
    EXPECT_EQ(scene.lights[0].name, "B");
    session_.undo();
    ASSERT_TRUE(save());
    scene = loadGltf(file());
    ASSERT_EQ(scene.lights.size(), 2u);
    EXPECT_EQ(scene.lights[0].name, "A") << "back in its node";
    EXPECT_EQ(bytesOf(file()).size(), both.size());

    change("Kind", [](SceneEdits& edits) { edits.lights[1].type = LightType::Rectangle; });
    ASSERT_TRUE(save());
    EXPECT_EQ(loadGltf(file()).lights[1].type, LightType::Rectangle);
    session_.undo();
    ASSERT_TRUE(save());
    EXPECT_EQ(loadGltf(file()).lights[1].type, LightType::Point);
}

TEST_F(SessionSaveTest, SavedAsItGoesOnThere) {
    open();
    const std::string first = bytesOf(file()), other = folder_.path("other.glb");
    addLamp("A");
    ASSERT_TRUE(save(other));
    EXPECT_EQ(session_.path(), other);
    EXPECT_EQ(bytesOf(file()), first);
    EXPECT_EQ(loadGltf(other).lights.size(), 1u);
    addLamp("B");
    ASSERT_TRUE(save());
    EXPECT_EQ(bytesOf(file()), first);
    EXPECT_EQ(loadGltf(other).lights.size(), 2u);
}

TEST_F(SessionSaveTest, ItsOwnSaveIsNotReadAgain) {
    open();
    session_.watchFile(true);
    addLamp("A");
    ASSERT_TRUE(save());
    EXPECT_FALSE(until([&] { return loads_ > 1; }, 2));
    writeFile(kScenes + "cornell_small.glb"); // by another program
    ASSERT_TRUE(until([&] { return loads_ == 2; }));
    EXPECT_TRUE(session_.document().edits.lights.empty()) << "as the file has it";
    EXPECT_FALSE(session_.dirty());
}

TEST_F(SessionSaveTest, AnotherSizeLosesNoEdit) {
    open();
    addLamp("A");
    ASSERT_TRUE(save());
    addLamp("B");
    const Document wanted = session_.document();
    Document next = wanted;
    next.bake.size = 2 * kSize;
    session_.edit("Size", next);
    session_.save(); // waits for the atlas
    ASSERT_TRUE(until([&] { return loads_ == 2 && !session_.saving(); }));
    EXPECT_EQ(session_.document().edits.lights, wanted.edits.lights);
    EXPECT_EQ(loadGltf(file()).lights.size(), 2u);
    EXPECT_EQ(nodesOf(file()), 2u);
    EXPECT_FALSE(session_.dirty());
}

TEST_F(SessionSaveTest, TheNewestWishCounts) {
    open();
    for (int i = 0; i < 20; ++i) {
        change("Dim",
               [](SceneEdits& edits) { edits.materials[0].emission = edits.materials[0].emission + 1.0f; });
        session_.save();
    }
    const float wanted = session_.document().edits.materials[0].emission.r;
    ASSERT_TRUE(until([&] { return !session_.saving(); }));
    EXPECT_FALSE(session_.dirty());
    EXPECT_EQ(loadGltf(file()).materials[0].emission.r, wanted);
    EXPECT_LT(session_.saves(), 20u);
}

TEST_F(SessionSaveTest, WhereNobodyWatchesASaveFindsItsNodesToo) {
    open();
    const std::vector<Instance> instances = session_.scene()->prepared.scene.instances;
    const std::string hidden = instances.at(0).name, other = instances.at(1).name;
    change("Hide", [](SceneEdits& edits) { edits.placements.at(0).hidden = true; });
    const std::string swapped = withJson(bytesOf(file()), [&](nlohmann::json& document) {
        const auto named = [&](const std::string& name) {
            return std::find_if(document["nodes"].begin(), document["nodes"].end(),
                                [&](const nlohmann::json& node) { return node.value("name", "") == name; });
        };
        ASSERT_NE(named(hidden), document["nodes"].end());
        ASSERT_NE(named(other), document["nodes"].end());
        std::swap(*named(hidden), *named(other)); // each has the other's number now
    });
    std::ofstream(folder_.path("swapped.glb"), std::ios::binary) << swapped;
    writeFile(folder_.path("swapped.glb"));
    ASSERT_TRUE(save());
    EXPECT_EQ(session_.saves(), 1u);
    for (const Instance& instance : loadGltf(file()).instances)
        EXPECT_EQ(instance.hidden, instance.name == hidden) << instance.name;
}

TEST_F(SessionSaveTest, WaitsForAFileThatIsWrittenAgainWhileItIsRead) {
    saveWhileItIsRead();
    Document next = session_.document();
    next.bake.size = 2 * kSize;
    session_.edit("Size", next); // reads it once more
    writeFile(kScenes + "cornell_small.glb");
    ASSERT_TRUE(until([&] { return !session_.loading() && !session_.saving(); }));
    EXPECT_EQ(session_.lastError(), "");
    EXPECT_EQ(session_.saves(), 1u);
    EXPECT_FALSE(session_.dirty());
    EXPECT_EQ(session_.scene()->size, 2 * kSize);
}

TEST_F(SessionSaveTest, WhatAnotherSceneOvertakesIsTold) {
    saveWhileItIsRead();
    session_.open(kScenes + "cornell_geom.glb");
    writeFile(kScenes + "cornell_small.glb");
    ASSERT_TRUE(until([&] { return session_.path() != file() && !session_.loading(); }));
    EXPECT_FALSE(session_.saving());
    EXPECT_NE(session_.lastError().find("not saved"), std::string::npos) << session_.lastError();
    EXPECT_EQ(session_.saves(), 0u);
}

TEST_F(SessionSaveTest, EditsMadeWhileAnotherSceneLoadsAreAskedAbout) {
    open();
    const std::string other = kScenes + "cornell_geom.glb";
    const auto openAndEdit = [&] {
        session_.open(other);
        addLamp("Late");
        ASSERT_TRUE(until([&] { return session_.arrival().waits(); }));
        EXPECT_EQ(session_.path(), file());
    };
    openAndEdit();
    session_.arrival().answer(false);
    ASSERT_TRUE(untilLoaded());
    EXPECT_EQ(session_.path(), file());
    EXPECT_EQ(session_.document().edits.lights.size(), 1u);
    EXPECT_FALSE(session_.takeOpenFailure());
    openAndEdit();
    session_.save();
    ASSERT_TRUE(until([&] { return session_.path() == other; })) << "nothing is lost any more";
    EXPECT_EQ(loadGltf(file()).lights.size(), 2u);
    EXPECT_EQ(session_.lastError(), "");
    open();
    openAndEdit();
    session_.arrival().answer(true);
    ASSERT_TRUE(until([&] { return session_.path() == other; }));
    EXPECT_EQ(loadGltf(file()).lights.size(), 2u);
}

TEST_F(SessionSaveTest, EditsBeforeAnotherSceneIsOpenedAreTheOpenersBusiness) {
    open();
    addLamp("Early");
    session_.open(kScenes + "cornell_geom.glb");
    ASSERT_TRUE(until([&] { return session_.path() != file(); }));
    EXPECT_FALSE(session_.arrival().waits());
}

TEST_F(SessionSaveTest, AFailureIsToldAndTheFileStays) {
    open();
    addLamp("A");
    const std::string before = bytesOf(file());
    setenv("TMPDIR", folder_.path("").c_str(), 1); // where it is saved instead
    EXPECT_FALSE(save(folder_.path("none/a.glb")));
    unsetenv("TMPDIR");
    EXPECT_NE(session_.lastError().find("none"), std::string::npos) << session_.lastError();
    EXPECT_TRUE(session_.dirty());
    EXPECT_EQ(session_.path(), file());
    session_.clearError();
    EXPECT_FALSE(save(folder_.path("a.gltf")));
    EXPECT_NE(session_.lastError().find(".glb"), std::string::npos);
    session_.clearError();
    EXPECT_EQ(bytesOf(file()), before);
    ASSERT_TRUE(save());
    EXPECT_EQ(loadGltf(file()).lights.size(), 1u);
    session_.open(kScenes + "cornell_geom.glb");
    session_.save();
    EXPECT_NE(session_.lastError().find("not saved while"), std::string::npos);
    ASSERT_TRUE(untilLoaded());
}

} // namespace
} // namespace relume
