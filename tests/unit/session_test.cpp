// The session without a Vulkan device: what is loaded, edited, undone. Bakes are counted, none runs.
#include "app/live/session.h"

#include "app/viewer/light_edits.h"
#include "assets/error.h"
#include "assets/gltf.h"
#include "assets/log.h"
#include "tests/temporary_folder.h"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <thread>

namespace relume {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;

const std::string kScenes = std::string(RELUME_SOURCE_DIR) + "/assets/scenes/";
constexpr uint32_t kSize = 64;

class SessionTest : public testing::Test {
protected:
    SessionTest() {
        fs::copy_file(kScenes + "cornell_small.glb", file(), fs::copy_options::overwrite_existing);
    }

    std::string file() const { return folder_.path("scene.glb"); }

    /// Frames until it is so. Counts the scenes that came.
    bool until(const std::function<bool()>& what, double seconds = 30) {
        const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
        while (std::chrono::steady_clock::now() < end) {
            loads_ += session_.update();
            if (what()) return true;
            std::this_thread::sleep_for(1ms);
        }
        return false;
    }
    bool untilLoaded() {
        return until([&] { return !session_.loading(); });
    }
    void open() {
        session_.open(file());
        ASSERT_TRUE(untilLoaded());
        ASSERT_NE(session_.scene(), nullptr);
    }
    /// Writes the scene file as an exporter does, with a newer time stamp.
    void writeFile(const std::string& from) {
        fs::copy_file(from, file(), fs::copy_options::overwrite_existing);
        fs::last_write_time(file(), time_ += 2s);
    }
    void dim(float factor, const std::string& name = "Emission") {
        Document next = session_.document();
        for (Material& material : next.edits.materials)
            material.emission *= factor;
        session_.edit(name, next);
    }
    float brightest() const {
        float most = 0;
        for (const Material& material : session_.document().edits.materials)
            most = std::max(most, material.emission.r);
        return most;
    }

    static BakeRequest request() {
        BakeRequest request;
        request.bake.size = kSize;
        return request;
    }

    const TemporaryFolder folder_;
    fs::file_time_type time_ = fs::file_time_type::clock::now();
    LiveBake bake_{{.device = "a device that nobody has"}};
    Session session_{bake_, request()};
    int loads_ = 0;
};

TEST_F(SessionTest, UndoesAndRedoesEveryEditByName) {
    open();
    const float first = brightest();
    ASSERT_GT(first, 0);
    EXPECT_FALSE(session_.undo());
    EXPECT_EQ(session_.undoName(), "");
    dim(0.5f, "Emission");
    session_.endEdit();
    Document next = session_.document();
    next.bake.solver.method = Method::MonteCarlo;
    session_.edit("Method", next);
    EXPECT_EQ(session_.undoName(), "Method");
    EXPECT_EQ(session_.redoName(), "");
    ASSERT_TRUE(session_.undo());
    EXPECT_NE(session_.document().bake.solver.method, Method::MonteCarlo);
    EXPECT_EQ(brightest(), 0.5f * first) << "one step at a time";
    EXPECT_EQ(session_.undoName(), "Emission");
    EXPECT_EQ(session_.redoName(), "Method");
    ASSERT_TRUE(session_.undo());
    EXPECT_EQ(brightest(), first);
    EXPECT_FALSE(session_.undo());
    ASSERT_TRUE(session_.redo());
    ASSERT_TRUE(session_.redo());
    EXPECT_FALSE(session_.redo());
    EXPECT_EQ(session_.document().bake.solver.method, Method::MonteCarlo);
    EXPECT_EQ(brightest(), 0.5f * first);
}

TEST_F(SessionTest, AnEditAfterUndoForgetsWhatWasUndone) {
    open();
    dim(0.5f, "A");
    session_.endEdit();
    dim(0.5f, "B");
    ASSERT_TRUE(session_.undo());
    dim(3.0f, "C");
    EXPECT_FALSE(session_.redo());
    EXPECT_EQ(session_.undoName(), "C");
    session_.undo();
    EXPECT_EQ(session_.undoName(), "A");
}

TEST_F(SessionTest, ADragIsOneStep) {
    open();
    const float first = brightest();
    for (int i = 0; i < 10; ++i)
        dim(0.9f, "Emission");
    session_.endEdit();
    const float dragged = brightest();
    dim(0.5f, "Emission"); // another drag of the same slider
    dim(0.5f, "Albedo");   // another slider, without an end in between
    ASSERT_TRUE(session_.undo());
    EXPECT_EQ(brightest(), 0.5f * dragged);
    ASSERT_TRUE(session_.undo());
    EXPECT_EQ(brightest(), dragged);
    ASSERT_TRUE(session_.undo());
    EXPECT_EQ(brightest(), first);
    EXPECT_FALSE(session_.undo());
    // After an undo the same name is another step.
    ASSERT_TRUE(session_.redo());
    dim(0.5f, "Emission");
    ASSERT_TRUE(session_.undo());
    EXPECT_EQ(brightest(), dragged);
}

TEST_F(SessionTest, ABadFileKeepsTheScene) {
    open();
    dim(0.5f);
    const LoadedScene* scene = session_.scene();
    const float edited = brightest();
    std::ofstream(folder_.path("bad.glb")) << "this is no scene";
    for (const std::string& path : {folder_.path("bad.glb"), folder_.path("none.glb")}) {
        session_.open(path);
        EXPECT_EQ(session_.loadingPath(), path);
        ASSERT_TRUE(untilLoaded());
        EXPECT_NE(session_.lastError().find(fs::path(path).filename().string()), std::string::npos)
            << session_.lastError();
        EXPECT_EQ(session_.scene(), scene);
        EXPECT_EQ(brightest(), edited);
        EXPECT_EQ(session_.undoName(), "Emission");
        session_.clearError();
    }
    EXPECT_EQ(loads_, 1);
    // What is watched is still the good one.
    session_.watchFile(true);
    writeFile(kScenes + "cornell_small.glb");
    ASSERT_TRUE(until([&] { return loads_ == 2; }));
    EXPECT_EQ(session_.lastError(), "");
}

TEST_F(SessionTest, LightsStayWhereTheAtlasBecomesAnother) {
    open();
    Document next = session_.document();
    next.edits.lights.emplace_back().name = "Added";
    next.edits.sky.radiance = glm::vec3(2.0f);
    next.mix.muted = {{LightKey::Kind::Lamp, 0, 0}};
    session_.edit("Add", next);
    next.bake.size = 2 * kSize;
    session_.edit("Size", next);
    ASSERT_TRUE(untilLoaded());
    ASSERT_EQ(session_.document().edits.lights.size(), 1u);
    EXPECT_EQ(session_.document().edits.lights[0].name, "Added");
    EXPECT_EQ(session_.document().edits.sky.radiance, glm::vec3(2.0f));
    EXPECT_EQ(session_.document().mix, next.mix);
    EXPECT_EQ(session_.undoName(), "Size");
}

TEST_F(SessionTest, AFileWithOtherInstancesForgetsSteps) {
    open();
    Document next = session_.document();
    next.edits.lights.emplace_back().name = "Added";
    session_.edit("Add", next);
    session_.watchFile(true);
    writeFile(kScenes + "cornell_geom.glb");
    ASSERT_TRUE(until([&] { return loads_ == 2; }));
    EXPECT_EQ(session_.undoName(), "") << "it would number instances that are gone";
    EXPECT_EQ(session_.document().edits.placements.size(), session_.scene()->prepared.scene.instances.size());
    ASSERT_EQ(session_.document().edits.lights.size(), 1u) << "the file has no lights, as before";
}

TEST_F(SessionTest, TheListOfLightsFollowsTheDocument) {
    LightList list;
    EXPECT_FALSE(list.update(session_.scene(), session_));
    open();
    ASSERT_TRUE(list.update(session_.scene(), session_));
    EXPECT_FALSE(list.update(session_.scene(), session_)) << "nothing happened";
    ASSERT_EQ(list.sources().size(), 1u);
    const LightKey emitter = list.sources()[0].key;
    EXPECT_EQ(emitter.kind, LightKey::Kind::Emitter);
    EXPECT_EQ(list.emittersOf(emitter.material), 1u);
    Document next = session_.document();
    const LightKey added = addLamp(next, {.name = "Lamp", .color = {1.0f, 0.5f, 0.25f}, .intensity = 4.0f});
    session_.edit("Add", next);
    ASSERT_TRUE(list.update(session_.scene(), session_));
    ASSERT_NE(list.find(added), nullptr);
    EXPECT_EQ(list.find(added)->name, "Lamp");
    EXPECT_EQ(list.find(added)->weight, glm::vec3(4.0f, 2.0f, 1.0f));
    ASSERT_TRUE(session_.undo());
    ASSERT_TRUE(list.update(session_.scene(), session_));
    EXPECT_EQ(list.find(added), nullptr);
    dim(0.0f);
    ASSERT_TRUE(list.update(session_.scene(), session_));
    EXPECT_TRUE(list.sources().empty()) << "it emits no more";
}

TEST_F(SessionTest, ACancelledEditHasNotBeen) {
    open();
    dim(0.5f, "Before");
    session_.endEdit();
    const float before = brightest();
    const uint64_t changes = session_.changes(), bake = session_.newestBake();
    dim(0.5f, "Drag");
    dim(0.5f, "Drag");
    EXPECT_GT(session_.changes(), changes);
    EXPECT_GT(session_.newestBake(), bake);
    session_.cancelEdit();
    EXPECT_EQ(brightest(), before);
    EXPECT_EQ(session_.undoName(), "Before");
    EXPECT_EQ(session_.redoName(), "");
    session_.cancelEdit(); // ended long ago: not taken back
    EXPECT_EQ(session_.undoName(), "Before");
}

TEST_F(SessionTest, AnotherSceneForgetsEditsAndSteps) {
    open();
    dim(0.5f);
    session_.open(kScenes + "cornell_geom.glb");
    ASSERT_TRUE(untilLoaded());
    EXPECT_EQ(loads_, 2);
    EXPECT_FALSE(session_.sceneWasKept());
    EXPECT_EQ(session_.undoName(), "");
    EXPECT_EQ(session_.document().edits.materials.size(), session_.scene()->prepared.scene.materials.size());
}

TEST_F(SessionTest, AFileThatIsWrittenTwiceIsReadTwice) {
    open();
    const uint64_t firstBake = session_.firstBake();
    std::this_thread::sleep_for(50ms);
    writeFile(kScenes + "cornell_small.glb");
    EXPECT_FALSE(until([&] { return loads_ > 1; }, 2)) << "nobody watches";
    session_.watchFile(true);
    ASSERT_TRUE(until([&] { return loads_ == 2; })) << "written before it was watched";
    EXPECT_TRUE(session_.sceneWasKept());
    dim(0.5f);
    const float edited = brightest();
    session_.endEdit();
    writeFile(kScenes + "cornell_small.glb");
    ASSERT_TRUE(until([&] { return loads_ == 3; }));
    EXPECT_EQ(brightest(), edited) << "an edit survives";
    EXPECT_TRUE(session_.undo()) << "and its step";
    EXPECT_GT(brightest(), edited);
    EXPECT_EQ(session_.firstBake(), firstBake) << "it is the same scene";
    EXPECT_FALSE(until([&] { return loads_ > 3; }, 2)) << "nothing was written";
}

TEST_F(SessionTest, AFileThatIsStillWrittenWaits) {
    open();
    session_.watchFile(true);
    std::ofstream(file()) << "half of a sc";
    int writes = 0;
    auto next = std::chrono::steady_clock::now();
    // For two seconds its time changes more often than it is looked at.
    until(
        [&] {
            const auto now = std::chrono::steady_clock::now();
            if (now < next) return false;
            next = now + 100ms;
            fs::last_write_time(file(), time_ += 1s);
            return ++writes == 20;
        },
        10);
    EXPECT_EQ(session_.lastError(), "") << "read too early";
    writeFile(kScenes + "cornell_small.glb");
    ASSERT_TRUE(until([&] { return loads_ == 2; }));
    EXPECT_EQ(session_.lastError(), "");
}

TEST_F(SessionTest, EditsOfAFileThatBecameAnotherGoByName) {
    open();
    dim(0.5f);
    session_.watchFile(true);
    writeFile(kScenes + "cornell_statue.glb");
    ASSERT_TRUE(until([&] { return loads_ == 2; }));
    const std::vector<Material>& own = session_.scene()->prepared.scene.materials;
    ASSERT_EQ(session_.document().edits.materials.size(), own.size());
    for (size_t i = 0; i < own.size(); ++i)
        EXPECT_EQ(session_.document().edits.materials[i].name, own[i].name);
}

TEST_F(SessionTest, AnotherSizeLoadsTheSceneAnew) {
    open();
    dim(0.5f);
    session_.endEdit();
    const float edited = brightest();
    Document next = session_.document();
    next.bake.size = 2 * kSize;
    session_.edit("Size", next);
    EXPECT_TRUE(session_.loading());
    ASSERT_TRUE(until([&] { return loads_ == 2; }));
    EXPECT_EQ(session_.scene()->size, 2 * kSize);
    EXPECT_TRUE(session_.sceneWasKept());
    EXPECT_EQ(brightest(), edited);
    ASSERT_TRUE(session_.undo());
    ASSERT_TRUE(until([&] { return loads_ == 3; }));
    EXPECT_EQ(session_.scene()->size, kSize);
    EXPECT_EQ(session_.document().bake.size, kSize);
    EXPECT_EQ(session_.undoName(), "Emission");
}

TEST_F(SessionTest, ASizeThatIsDraggedEndsWithTheLast) {
    open();
    for (const uint32_t size : {80u, 96u, 112u}) {
        Document next = session_.document();
        next.bake.size = size;
        session_.edit("Size", next);
    }
    ASSERT_TRUE(untilLoaded());
    EXPECT_EQ(session_.scene()->size, 112u);
    EXPECT_EQ(session_.document().bake.size, 112u);
}

/// Edits saved into the scene's file.
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
    static size_t nodesOf(const std::string& path) {
        const std::string bytes = bytesOf(path);
        size_t count = 0;
        for (size_t at = bytes.find("\"light\":"); at != std::string::npos;
             at = bytes.find("\"light\":", at + 1))
            ++count;
        return count;
    }
    static std::string bytesOf(const std::string& path) {
        std::ifstream stream(path, std::ios::binary);
        return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
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
    EXPECT_FALSE(session_.dirty()) << "a file cannot hide";
    EXPECT_EQ(bytesOf(file()), before) << "a value that is edited back is what it was";
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

TEST_F(SessionSaveTest, AFailureIsToldAndTheFileStays) {
    open();
    addLamp("A");
    const std::string before = bytesOf(file());
    EXPECT_FALSE(save(folder_.path("none/a.glb")));
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
