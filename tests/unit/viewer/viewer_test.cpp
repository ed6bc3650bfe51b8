#include "app/viewer/edits/light_edits.h"
#include "app/viewer/panels/scene_panel.h"
#include "app/viewer/picture/capture.h"
#include "app/viewer/shell/view_options.h"
#include "app/viewer/state/camera_control.h"
#include "app/viewer/state/log_buffer.h"
#include "app/viewer/state/shortcuts.h"
#include "app/viewer/state/views.h"
#include "app/viewer/window/messages.h"
#include "app/viewer/window/redraw_pacer.h"
#include "tests/temporary_folder.h"

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <set>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <gtest/gtest.h>

namespace relume {
namespace {

namespace fs = std::filesystem;

TEST(Shortcuts, NoKeyDoesTwoThings) {
    std::set<std::pair<int, int>> keys;
    for (const Shortcut& shortcut : shortcuts()) {
        if (shortcut.key == 0) continue;
        EXPECT_TRUE(keys.insert({shortcut.key, shortcut.mods}).second) << keyText(shortcut);
        EXPECT_EQ(findShortcut(shortcut.key, shortcut.mods), &shortcut) << keyText(shortcut);
    }
}

TEST(Shortcuts, ANameMeansOneAction) {
    std::map<std::string, std::pair<Action, int>> names;
    for (const Shortcut& shortcut : shortcuts()) {
        const std::pair what(shortcut.action, shortcut.argument);
        const auto [known, fresh] = names.try_emplace(shortcut.name, what);
        EXPECT_EQ(known->second, what) << shortcut.name;
    }
}

TEST(Shortcuts, FlightHasItsKeysForItself) {
    for (const int key : {GLFW_KEY_W, GLFW_KEY_A, GLFW_KEY_S, GLFW_KEY_D, GLFW_KEY_Q, GLFW_KEY_E}) {
        EXPECT_EQ(findShortcut(key, 0), nullptr);
        EXPECT_EQ(findShortcut(key, GLFW_MOD_SHIFT), nullptr); // faster
    }
}

TEST(Shortcuts, LocksOfTheKeyboardDoNotMatter) {
    const Shortcut* found = findShortcut(GLFW_KEY_Z, GLFW_MOD_CONTROL | GLFW_MOD_NUM_LOCK);
    ASSERT_NE(found, nullptr);
    EXPECT_EQ(found->action, Action::Undo);
    EXPECT_EQ(keyText(*found), "Ctrl+Z");
    EXPECT_EQ(keyText(shortcutOf(Action::Redo)), "Ctrl+Shift+Z");
}

TEST(Views, EachHasAKeyAndAName) {
    std::set<std::string> names;
    for (const ViewEntry& entry : viewEntries()) {
        EXPECT_TRUE(names.insert(entry.name).second) << entry.name;
        EXPECT_NE(entry.key, 0) << entry.name;
    }
    EXPECT_STREQ(viewEntries()[viewIndex("ligOut")].title, "ligOut");
}

TEST(RedrawPacer, DrawsNothingWhereNothingHappens) {
    RedrawPacer pacer;
    double now = 0;
    while (pacer.due(now).any)
        pacer.drawn(pacer.due(now), now, 0.01);
    EXPECT_FALSE(pacer.due(1e6).any);
    EXPECT_EQ(pacer.wait(now, 7.0), 7.0);
}

// Returns a pacer that has drawn all that it begins with, at time 0 and for 40 ms each.
RedrawPacer settled() {
    RedrawPacer pacer;
    while (pacer.due(0).any)
        pacer.drawn({true, true}, 0, 0.04);
    return pacer;
}

TEST(RedrawPacer, MapsAloneTakeAThirdOfTheTime) {
    RedrawPacer pacer = settled();
    double now = 0, drawing = 0;
    while (now < 60) {
        pacer.newMap(); // there is always another one
        pacer.statusChanged();
        now += std::max(pacer.wait(now, 1.0), 1e-4);
        const Redraw redraw = pacer.due(now);
        if (!redraw.any) continue;
        const double cost = redraw.scene ? 0.04 : 0.01;
        now += cost;
        drawing += cost;
        pacer.drawn(redraw, now, cost);
    }
    EXPECT_LE(drawing / now, 0.34);
    EXPECT_GE(drawing / now, 0.25); // and no less than it may
}

TEST(RedrawPacer, WhatTheUserDoesIsDrawnAtOnce) {
    RedrawPacer pacer = settled();
    EXPECT_FALSE(pacer.due(0).any);
    pacer.sceneChanged();
    EXPECT_TRUE(pacer.due(0).scene);
    pacer.drawn(pacer.due(0), 0, 0.04);
    pacer.input();
    EXPECT_TRUE(pacer.due(0).any);
    EXPECT_FALSE(pacer.due(0).scene); // panels alone: the picture of the scene is the same
}

TEST(RedrawPacer, FiguresComeTenTimesASecond) {
    RedrawPacer pacer = settled();
    pacer.drawn({false, true}, 0, 0.001);
    pacer.statusChanged();
    EXPECT_FALSE(pacer.due(0.05).any);
    EXPECT_NEAR(pacer.wait(0.05, 1.0), 0.05, 1e-9);
    EXPECT_TRUE(pacer.due(0.1001).any);
    EXPECT_TRUE(pacer.settled()); // nobody waits for figures
}

TEST(RedrawPacer, PicturesBesideTheSceneComeWithFiguresAndAreWaitedFor) {
    RedrawPacer pacer = settled();
    pacer.drawn({false, true}, 0, 0.001);
    pacer.smallPictureChanged();
    EXPECT_FALSE(pacer.settled());
    EXPECT_FALSE(pacer.due(0.05).any);
    const Redraw redraw = pacer.due(0.1001);
    EXPECT_TRUE(redraw.any);
    EXPECT_FALSE(redraw.scene);
    pacer.drawn(redraw, 0.11, 0.001);
    EXPECT_TRUE(pacer.settled());
}

Box boxAroundOrigin() {
    Box box;
    box.add(glm::vec3(-1));
    box.add(glm::vec3(1));
    return box;
}

CameraControl aheadOfBox() {
    CameraControl control;
    ViewCamera camera;
    camera.eye = {0, 0, 5};
    control.set(camera, boxAroundOrigin());
    return control;
}

TEST(CameraControl, MovesOnlyWhileDragged) {
    CameraControl control = aheadOfBox();
    EXPECT_FALSE(control.move(0.1f, 0.1f));
    control.begin(CameraControl::Drag::Orbit);
    EXPECT_TRUE(control.move(0.1f, 0));
    EXPECT_NEAR(glm::distance(control.camera().eye, control.camera().target), 5.0f, 1e-4f);
    EXPECT_LT(control.camera().eye.x, 0.0f); // the scene follows the hand to the right
    control.end();
    EXPECT_FALSE(control.move(0.1f, 0));
}

TEST(CameraControl, PanningKeepsWhatIsUnderTheCursor) {
    CameraControl control = aheadOfBox();
    control.begin(CameraControl::Drag::Pan);
    const float height = 2 * 5.0f * std::tan(0.5f * control.camera().yfov);
    control.move(0.25f, 0.5f);
    EXPECT_NEAR(control.camera().target.x, -0.25f * height, 1e-4f);
    EXPECT_NEAR(control.camera().target.y, 0.5f * height, 1e-4f);
}

TEST(CameraControl, ZoomComesCloserAndNeverThrough) {
    CameraControl control = aheadOfBox();
    control.zoomBy(1);
    EXPECT_LT(glm::distance(control.camera().eye, control.camera().target), 5.0f);
    control.zoomBy(10000);
    EXPECT_GT(glm::distance(control.camera().eye, control.camera().target), 0.0f);
    control.zoomBy(-10000);
    EXPECT_TRUE(std::isfinite(control.camera().eye.z));
}

TEST(CameraControl, FlightIsAsFastAsTheSceneIsLarge) {
    CameraControl control = aheadOfBox();
    EXPECT_FALSE(control.fly(0.05));
    control.setFlight({{0, 0, 1}, false});
    EXPECT_TRUE(control.fly(0.05));
    const float slow = 5.0f - control.camera().eye.z;
    EXPECT_NEAR(slow, 0.05f * boxAroundOrigin().diagonal() / 4, 1e-4f);
    control.setFlight({{0, 0, 1}, true});
    control.fly(0.05);
    EXPECT_NEAR(5.0f - slow - control.camera().eye.z, 4 * slow, 1e-4f);
    // After a stall it goes on where it was.
    const float before = control.camera().eye.z;
    control.fly(1e6);
    EXPECT_LT(before - control.camera().eye.z, boxAroundOrigin().diagonal());
}

TEST(CameraControl, ResetGoesHome) {
    CameraControl control = aheadOfBox();
    control.setHome(control.camera());
    control.begin(CameraControl::Drag::Look);
    control.move(0.3f, 0.2f);
    EXPECT_NE(control.camera().target, glm::vec3(0));
    control.reset();
    EXPECT_EQ(control.camera().target, glm::vec3(0));
}

TEST(Messages, StayForSomeSecondsAndNotTwice) {
    Messages messages;
    messages.add("a", false, 0);
    messages.add("a", true, 1);
    ASSERT_EQ(messages.shown().size(), 1u);
    EXPECT_TRUE(messages.shown().front().bad);
    EXPECT_GT(messages.nextExpiry(100), 4);
    messages.expire(100);
    EXPECT_TRUE(messages.shown().empty());
    EXPECT_EQ(messages.nextExpiry(100), 100);
}

TEST(LogBuffer, KeepsWhatIsLogged) {
    const auto usual = spdlog::default_logger();
    spdlog::set_default_logger(std::make_shared<spdlog::logger>("quiet")); // thousands of lines on stderr
    auto owner = std::make_unique<LogBuffer>();                            // goes before the logger does
    LogBuffer& buffer = *owner;
    const uint64_t before = buffer.count();
    spdlog::error("something {}", 7);
    ASSERT_EQ(buffer.linesSince(before).size(), 1u);
    EXPECT_EQ(buffer.linesSince(before).front().text, "something 7");
    for (size_t i = 0; i < LogBuffer::kMostLines + 10; ++i)
        spdlog::error("line {}", i);
    EXPECT_EQ(buffer.lines().size(), LogBuffer::kMostLines);
    EXPECT_EQ(buffer.linesSince(before).size(), LogBuffer::kMostLines);
    owner.reset();
    spdlog::set_default_logger(usual);
}

TEST(Emission, PartsMakeTheWholeAgain) {
    const glm::vec3 emission(2, 8, 4);
    const EmissionParts parts = splitEmission(emission);
    EXPECT_EQ(parts.strength, 8.0f);
    EXPECT_EQ(parts.colour * parts.strength, emission);
    EXPECT_EQ(splitEmission(glm::vec3(0)).strength, 0.0f);
}

TEST(ViewVerb, ASceneAloneIsOpened) {
    const std::vector<std::string> verbs = {"view", "bake"};
    using List = std::vector<std::string>;
    EXPECT_EQ(withViewVerb({"room.glb"}, verbs), List({"view", "room.glb"}));
    EXPECT_EQ(withViewVerb({"-q", "ROOM.GLTF", "--watch"}, verbs),
              List({"-q", "view", "ROOM.GLTF", "--watch"}));
    EXPECT_EQ(withViewVerb({"bake", "room.glb"}, verbs), List({"bake", "room.glb"}));
    EXPECT_EQ(withViewVerb({"bkae"}, verbs), List({"bkae"})); // a slip, to be told as one
    EXPECT_EQ(withViewVerb({}, verbs), List());
}

TEST(ViewOptions, WindowSizesAreChecked) {
    ViewOptions options;
    options.window = "800x600";
    const ViewerDesc desc = resolveViewOptions(options);
    EXPECT_EQ(desc.width, 800u);
    EXPECT_EQ(desc.height, 600u);
    for (const char* wrong : {"800", "800x", "x600", "800x600x2", "8x6", "-800x600", "800x99999"}) {
        options.window = wrong;
        EXPECT_THROW(resolveViewOptions(options), UsageError) << wrong;
    }
}

class CaptureName : public testing::Test {
protected:
    const TemporaryFolder folder_;
};

TEST_F(CaptureName, NoNumberComesTwice) {
    std::set<std::string> names;
    for (const char* ending : {".png", ".png", ".mp4", "", ".png"}) {
        const std::string name = captureName(folder_.path(), ending);
        EXPECT_TRUE(names.insert(fs::path(name).stem().string()).second) << name;
        std::ofstream(name) << "x";
    }
    EXPECT_TRUE(fs::path(*names.rbegin()).string().ends_with("_005"));
}

TEST_F(CaptureName, FollowsTheHighestNumber) {
    const std::string first = captureName(folder_.path(), ".png");
    ASSERT_TRUE(first.ends_with("_001.png"));
    std::ofstream(first.substr(0, first.size() - 7) + "1234.png") << "x";
    EXPECT_TRUE(captureName(folder_.path(), ".png").ends_with("_1235.png"));
}

TEST_F(CaptureName, ScreenshotsAreWrittenWithoutOverwriting) {
    {
        Capture capture;
        for (uint8_t shade : {0, 255})
            capture.screenshot({2, 2, std::vector<uint8_t>(16, shade)}, folder_.path());
    } // which waits for them
    std::vector<fs::path> files(fs::directory_iterator{folder_.path()}, fs::directory_iterator{});
    EXPECT_EQ(files.size(), 2u);
}

// Two viewers that write into one folder take their names at the same time.
TEST_F(CaptureName, ManyWritersLoseNoScreenshot) {
    constexpr size_t kWriters = 4, kEach = 8;
    {
        std::array<Capture, kWriters> writers;
        for (size_t shot = 0; shot < kEach; ++shot)
            for (Capture& writer : writers)
                writer.screenshot({2, 2, std::vector<uint8_t>(16, uint8_t{1})}, folder_.path());
    }
    size_t files = 0;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_.path())) {
        ++files;
        EXPECT_GT(fs::file_size(entry), 0u) << entry.path();
    }
    EXPECT_EQ(files, kWriters * kEach);
}

TEST_F(CaptureName, ManyWritersLoseNoRecording) {
    constexpr size_t kWriters = 4;
    {
        std::array<Capture, kWriters> writers;
        for (Capture& writer : writers) {
            writer.start(folder_.path(), 1.0);
            writer.frame({4, 4, std::vector<uint8_t>(64, 40)}, 1.0);
        }
        for (Capture& writer : writers)
            writer.stop(2.0);
    }
    EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path()), fs::directory_iterator{}),
              std::ptrdiff_t{kWriters});
}

TEST_F(CaptureName, AScreenshotThatFailsLeavesRecordings) {
    std::ofstream(folder_.path("file")) << "no folder";
    const auto pixels = [](uint8_t shade) { return Pixels{4, 4, std::vector<uint8_t>(64, shade)}; };
    const std::string during = folder_.path("during"), after = folder_.path("after");
    {
        Capture capture;
        capture.start(during, 1.0);
        capture.frame(pixels(40), 1.0);
        capture.frame(pixels(90), 1.5); // which writes the first one
        capture.screenshot(pixels(1), folder_.path("file"));
        capture.stop(2.0);
        capture.screenshot(pixels(1), folder_.path("file"));
        capture.start(after, 3.0);
        capture.frame(pixels(40), 3.0);
        capture.stop(4.0);
    }
    for (const std::string& folder : {during, after}) {
        ASSERT_TRUE(fs::exists(folder)) << folder;
        const std::vector<fs::path> files(fs::directory_iterator{folder}, fs::directory_iterator{});
        ASSERT_EQ(files.size(), 1u) << folder << ": one recording";
        EXPECT_TRUE(fs::is_directory(files[0]) || fs::file_size(files[0]) > 0) << files[0];
    }
}

TEST_F(CaptureName, ARecordingHoldsWhatWasOnScreen) {
    {
        Capture capture;
        capture.start(folder_.path(), 10.0);
        EXPECT_TRUE(capture.wants(10.0));
        capture.frame({4, 4, std::vector<uint8_t>(64, 40)}, 10.0);
        EXPECT_FALSE(capture.wants(10.01)); // sooner than the next frame of a video
        capture.frame({4, 4, std::vector<uint8_t>(64, 200)}, 10.5);
        capture.stop(11.0);
        EXPECT_FALSE(capture.recording());
    }
    size_t entries = 0, frames = 0;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_.path())) {
        ++entries;
        if (!entry.is_directory()) continue;
        for ([[maybe_unused]] const fs::directory_entry& frame : fs::directory_iterator(entry.path()))
            ++frames;
    }
    EXPECT_EQ(entries, 1u); // a video where there is ffmpeg
    if (frames > 0) {
        EXPECT_EQ(frames, 2u);
    }
}

} // namespace
} // namespace relume
