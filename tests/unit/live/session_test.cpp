// This tests the session without a Vulkan device: what is loaded, edited, undone. Bakes are counted, and none
// runs.
#include "app/live/session.h"

#include "app/viewer/edits/light_edits.h"
#include "assets/base/error.h"
#include "assets/base/log.h"
#include "assets/gltf/gltf.h"
#include "tests/unit/session_fixture.h"

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
        EXPECT_EQ(session_.loader().path(), path);
        ASSERT_TRUE(untilLoaded());
        const std::optional<OpenFailure> failure = session_.takeOpenFailure();
        ASSERT_TRUE(failure);
        EXPECT_EQ(failure->path, path);
        EXPECT_TRUE(failure->message.starts_with(path + ": ")) << failure->message;
        EXPECT_FALSE(session_.takeOpenFailure()) << "it is told once";
        EXPECT_EQ(session_.scene(), scene);
        EXPECT_EQ(brightest(), edited);
        EXPECT_EQ(session_.undoName(), "Emission");
        EXPECT_EQ(session_.lastError(), "");
    }
    EXPECT_EQ(loads_, 1);
    // The good file is still watched.
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

TEST_F(SessionTest, ASizeThatIsEditedWhileAnotherSceneLoadsLeavesThatOnItsWay) {
    open();
    const auto resize = [&](uint32_t size) {
        Document next = session_.document();
        next.bake.size = size;
        session_.edit("Size", next);
        session_.endEdit();
    };
    const std::string other = kScenes + "cornell_geom.glb";
    session_.open(other);
    resize(2 * kSize);
    ASSERT_TRUE(untilLoaded());
    EXPECT_EQ(session_.path(), other);
    EXPECT_EQ(session_.scene()->size, 2 * kSize);
    // Where the other one cannot be read, the present one gets its size.
    std::ofstream(folder_.path("bad.glb")) << "this is no scene";
    session_.open(folder_.path("bad.glb"));
    resize(kSize);
    ASSERT_TRUE(untilLoaded());
    EXPECT_EQ(session_.path(), other);
    EXPECT_TRUE(session_.takeOpenFailure());
    EXPECT_EQ(session_.scene()->size, kSize);
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

} // namespace
} // namespace relume
