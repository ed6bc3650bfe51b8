// The viewer under a virtual display, driven by keys and a mouse.
#include "tests/ui/file_drop.h"
#include "tests/ui/viewer_fixture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <random>

namespace relume {
namespace {

using Clock = std::chrono::steady_clock;

class Viewer : public ViewerTest {};

TEST_F(Viewer, ShowsTheWindowBeforeTheScene) {
    auto viewer = open({"view", kScenes + "atrium.glb"});
    EXPECT_EQ(viewer->output().find("scene: "), std::string::npos) << "the window comes first";
    EXPECT_TRUE(viewer->says("scene: ", 60)) << viewer->output();
    EXPECT_TRUE(viewer->says("middle: opening over scene", 1)) << "the file is named meanwhile";
    EXPECT_TRUE(viewer->says("middle: scene")) << viewer->output();
    quit(*viewer);
}

TEST_F(Viewer, TakesASceneWithoutAVerb) {
    auto viewer = open({kScenes + "cornell_small.glb"});
    EXPECT_TRUE(viewer->says("scene: ")) << viewer->output();
    quit(*viewer);
}

TEST_F(Viewer, OrbitsZoomsAndFramesAll) {
    auto viewer = openCornell();
    const FloatImage before = screenshot(*viewer);
    EXPECT_GT(mean(before), 0.01) << "the picture is black";
    viewer->drag(640, 400, 760, 440);
    const FloatImage turned = screenshot(*viewer);
    EXPECT_GT(difference(before, turned), 0.005);
    viewer->moveTo(640, 400);
    viewer->wheel(3);
    const FloatImage near = screenshot(*viewer);
    EXPECT_GT(difference(turned, near), 0.005);
    viewer->keys({"Home"});
    EXPECT_GT(difference(near, screenshot(*viewer)), 0.005);
    viewer->keys({"shift+Home"});
    EXPECT_LT(difference(before, screenshot(*viewer)), 0.002) << "the camera is where it was at first";
    quit(*viewer);
}

TEST_F(Viewer, EveryViewKeyShowsItsView) {
    auto viewer = openCornell();
    std::vector<FloatImage> pictures;
    for (const char* key : {"1", "2", "3", "4", "5", "6", "7"}) {
        viewer->mark();
        viewer->keys({key});
        // Settled with the map that has what the view shows, and not after the screenshot before.
        EXPECT_TRUE(viewer->shows("action: ", 60)) << viewer->output();
        pictures.push_back(screenshot(*viewer));
        EXPECT_GT(mean(pictures.back()), 0.001) << "view " << key << " is black";
        for (size_t i = 0; i + 1 < pictures.size(); ++i)
            EXPECT_GT(difference(pictures[i], pictures.back()), 0.001) << "views " << i + 1 << " and " << key;
    }
    viewer->mark();
    viewer->keys({"1"});
    EXPECT_TRUE(viewer->shows("action: ", 60)) << viewer->output();
    EXPECT_LT(difference(pictures.front(), screenshot(*viewer)), 0.002);
    viewer->keys({"u"});
    EXPECT_GT(difference(pictures.front(), screenshot(*viewer)), 0.005) << "the UV texture";
    quit(*viewer);
}

TEST_F(Viewer, AnEmissionIsEditedAndUndone) {
    auto viewer = openCornell();
    const FloatImage before = screenshot(*viewer);
    viewer->keys({"alt+3"});
    viewer->settle();
    const auto material = item(*viewer, "Scene/Light (emits)");
    ASSERT_TRUE(material) << viewer->output();
    viewer->click(material->first, material->second);
    viewer->settle();
    const auto place = item(*viewer, "Scene/Light/Emission [cd/m^2]");
    ASSERT_TRUE(place) << viewer->output();
    viewer->mark();
    viewer->drag(place->first, place->second, place->first + 60, place->second);
    EXPECT_TRUE(viewer->says("edit: ")) << viewer->output();
    EXPECT_TRUE(viewer->shows("bake: done", 240)) << viewer->output();
    const FloatImage edited = screenshot(*viewer);
    EXPECT_GT(std::abs(mean(edited) - mean(before)), 0.005);
    viewer->mark();
    viewer->keys({"ctrl+z"});
    EXPECT_TRUE(viewer->says("undo: ")) << viewer->output();
    EXPECT_TRUE(viewer->shows("bake: done", 240)) << viewer->output();
    EXPECT_LT(difference(before, screenshot(*viewer)), 0.003);
    viewer->mark();
    viewer->keys({"ctrl+shift+z"});
    EXPECT_TRUE(viewer->says("redo: ")) << viewer->output();
    quit(*viewer);
}

TEST_F(Viewer, MakesPassesPausesAndResets) {
    auto viewer = open({"view", kScenes + "cornell_geom.glb", "--method", "montecarlo", "--passes", "40"});
    ASSERT_TRUE(viewer->says("bake: baking", 120)) << viewer->output();
    viewer->mark();
    viewer->keys({"space"});
    EXPECT_TRUE(viewer->says("bake: paused")) << viewer->output();
    viewer->mark();
    viewer->keys({"p"});
    EXPECT_TRUE(viewer->says("action: Make pass")) << viewer->output();
    EXPECT_TRUE(viewer->says("bake: paused", 60)) << viewer->output();
    viewer->mark();
    viewer->keys({"space"});
    EXPECT_TRUE(viewer->says("bake: baking")) << viewer->output();
    viewer->keys({"Escape"});
    EXPECT_TRUE(viewer->says("given up")) << viewer->output();
    viewer->keys({"ctrl+r", "space"});
    EXPECT_TRUE(viewer->says("action: Reset")) << viewer->output();
    quit(*viewer);
}

TEST_F(Viewer, ResizesAndMinimises) {
    auto viewer = openCornell();
    viewer->mark();
    viewer->resize(700, 500);
    EXPECT_TRUE(viewer->says("window: 700 x 500")) << viewer->output();
    EXPECT_GT(mean(screenshot(*viewer)), 0.01);
    viewer->resize(60, 40);
    viewer->resize(900, 600);
    EXPECT_TRUE(viewer->says("window: 900 x 600")) << viewer->output();
    viewer->xdotool({"windowminimize", std::to_string(viewer->windowId())});
    viewer->xdotool({"windowunmap", "--sync", std::to_string(viewer->windowId())});
    viewer->xdotool({"windowmap", "--sync", std::to_string(viewer->windowId())});
    viewer->xdotool({"windowfocus", "--sync", std::to_string(viewer->windowId())});
    EXPECT_GT(mean(screenshot(*viewer)), 0.01);
    quit(*viewer);
}

TEST_F(Viewer, ABadFileLeavesTheSceneThatIsThere) {
    auto viewer = openCornell();
    const FloatImage before = screenshot(*viewer);
    const std::string bad = home_.path("bad.glb");
    std::ofstream(bad) << "this is no glTF";
    viewer->mark();
    ASSERT_TRUE(dropFile(display_->name(), viewer->windowId(), bad));
    EXPECT_TRUE(viewer->says("bad.glb: ")) << viewer->output();
    EXPECT_TRUE(viewer->says("error: ")) << viewer->output();
    EXPECT_LT(difference(before, screenshot(*viewer)), 0.002);
    viewer->mark();
    ASSERT_TRUE(dropFile(display_->name(), viewer->windowId(), kScenes + "cornell_geom.glb"));
    EXPECT_TRUE(viewer->says("scene: ", 60)) << viewer->output();
    quit(*viewer);
}

TEST_F(Viewer, ScreenshotsNeverOverwrite) {
    auto viewer = openCornell();
    const FloatImage plain = screenshot(*viewer), withUi = screenshot(*viewer, "shift+F12");
    EXPECT_GT(difference(plain, withUi), 0.005) << "panels are in one of them only";
    for (int i = 0; i < 3; ++i)
        screenshot(*viewer);
    const std::string text = viewer->output();
    std::vector<std::string> names;
    for (size_t at = text.find("wrote "); at != std::string::npos; at = text.find("wrote ", at + 1))
        names.push_back(text.substr(at, text.find('\n', at) - at));
    std::sort(names.begin(), names.end());
    EXPECT_EQ(names.size(), 5u);
    EXPECT_EQ(std::adjacent_find(names.begin(), names.end()), names.end()) << "a name came twice";
    quit(*viewer);
}

// The camera goes by itself, picture by picture, and comes back.
TEST_F(Viewer, RecordsATourAndComesBack) {
    auto viewer = openCornell();
    viewer->resize(480, 360);
    viewer->settle();
    viewer->mark();
    viewer->keys({"alt+F12"});
    EXPECT_TRUE(viewer->says("two bookmarks")) << viewer->output();
    viewer->keys({"ctrl+b"});
    viewer->drag(300, 200, 340, 210);
    viewer->keys({"ctrl+b"});
    viewer->settle();
    const FloatImage before = screenshot(*viewer);
    viewer->mark();
    viewer->keys({"alt+F12"});
    EXPECT_TRUE(viewer->says("recording")) << viewer->output();
    EXPECT_TRUE(viewer->says("(91 frames)", 240)) << "three seconds, and both ends: " << viewer->output();
    viewer->settle();
    EXPECT_LT(difference(before, screenshot(*viewer)), 0.002) << "the camera is where it was";
    viewer->mark();
    viewer->keys({"ctrl+shift+F12"});
    EXPECT_TRUE(viewer->says("recording")) << viewer->output();
    viewer->keys({"ctrl+F12"});
    EXPECT_TRUE(viewer->says(" frames)", 240)) << "a tour can be ended: " << viewer->output();
    EXPECT_FALSE(viewer->says("(360 frames)", 0.1));
    viewer->settle();
    EXPECT_LT(difference(before, screenshot(*viewer)), 0.002);
    quit(*viewer);
}

// ImGui aborts where modifiers change while a text is being drawn.
TEST_F(Viewer, ModifiersMayBePressedAndReleasedWithinAFrame) {
    auto viewer = openCornell();
    viewer->keys({"ctrl+o"});
    EXPECT_TRUE(viewer->says("action: Open scene")) << viewer->output();
    for (int i = 0; i < 20; ++i)
        viewer->xdotool({"key", "--delay", "0", "ctrl+a", "shift+a", "alt+a", "ctrl+a"});
    EXPECT_TRUE(viewer->runs()) << viewer->output();
    viewer->keys({"Escape"});
    quit(*viewer);
}

TEST_F(Viewer, QuitsWhileItBakes) {
    auto viewer = open({"view", kScenes + "cornell_statue.glb", "--error", "0.0001"});
    ASSERT_TRUE(viewer->says("bake: baking", 120)) << viewer->output();
    quit(*viewer);
}

TEST_F(Viewer, ReloadsShaders) {
    const std::string shaders = home_.path("shaders");
    std::filesystem::copy(std::string(RELUME_SOURCE_DIR) + "/shaders", shaders,
                          std::filesystem::copy_options::recursive);
    auto viewer = open({"view", kScenes + "cornell_small.glb", "--shaders", shaders});
    ASSERT_TRUE(viewer->shows("bake: done", 240)) << viewer->output();
    viewer->keys({"bracketleft"}); // exposure by hand: automatic would follow what is to be compared
    viewer->settle();
    const FloatImage before = screenshot(*viewer);
    std::ofstream(shaders + "/gl/scene.frag", std::ios::app) << "\nthis is no GLSL\n";
    viewer->mark();
    viewer->keys({"F5"});
    EXPECT_TRUE(viewer->says("scene.frag")) << viewer->output();
    EXPECT_LT(difference(before, screenshot(*viewer)), 0.002) << "the old shaders stay";
    const std::string sources = std::string(RELUME_SOURCE_DIR) + "/shaders";
    std::filesystem::copy(sources + "/gl/scene.frag", shaders + "/gl/scene.frag",
                          std::filesystem::copy_options::overwrite_existing);
    std::ofstream(shaders + "/gather/resolve.comp", std::ios::app) << "\nthis is no GLSL\n";
    viewer->mark();
    viewer->keys({"F5"});
    EXPECT_TRUE(viewer->says("resolve.comp")) << viewer->output();
    EXPECT_LT(difference(before, screenshot(*viewer)), 0.002) << "so do the old kernels";
    std::filesystem::copy(sources + "/gather/resolve.comp", shaders + "/gather/resolve.comp",
                          std::filesystem::copy_options::overwrite_existing);
    viewer->mark();
    viewer->keys({"F5"});
    EXPECT_TRUE(viewer->shows("bake: done", 240)) << "the bake begins again: " << viewer->output();
    EXPECT_LT(difference(before, screenshot(*viewer)), 0.002);
    quit(*viewer);
}

/// Input that nobody planned.
TEST_F(Viewer, SurvivesRandomInput) {
    // Ten minutes by RELUME_RANDOM_INPUT_SECONDS=600.
    const char* wanted = std::getenv("RELUME_RANDOM_INPUT_SECONDS");
    const double seconds = wanted != nullptr ? std::atof(wanted) : 20;
    auto viewer = openCornell();
    viewer->setPatience(0.1); // nothing comes of much of it
    std::mt19937 random(7);
    const auto number = [&](int most) {
        return static_cast<int>(random() % static_cast<unsigned>(most + 1));
    };
    const std::vector<std::string> keys = {"1",           "2",
                                           "3",           "4",
                                           "5",           "6",
                                           "7",           "8",
                                           "9",           "0",
                                           "u",           "m",
                                           "t",           "x",
                                           "f",           "w",
                                           "a",           "s",
                                           "d",           "space",
                                           "p",           "period",
                                           "ctrl+r",      "Escape",
                                           "ctrl+z",      "ctrl+shift+z",
                                           "F1",          "F2",
                                           "F5",          "Home",
                                           "bracketleft", "bracketright",
                                           "alt+1",       "alt+2",
                                           "alt+3",       "alt+4",
                                           "alt+5",       "alt+6",
                                           "ctrl+1",      "ctrl+2",
                                           "ctrl+4",      "ctrl+6",
                                           "ctrl+d",      "Delete",
                                           "h",           "alt+h",
                                           "alt+l",       "shift+l",
                                           "l",           "alt+s",
                                           "alt+m",       "alt+Left",
                                           "r",           "i",
                                           "b",           "shift+b",
                                           "shift+t",     "shift+f",
                                           "Tab",         "Return",
                                           "ctrl+b",      "ctrl+o",
                                           "Down",        "Up"};
    const auto start = Clock::now();
    double anonymous = 0; // the most [MiB]
    int step = 0;
    for (; Clock::now() - start < std::chrono::duration<double>(seconds) && viewer->runs(); ++step) {
        switch (number(5)) {
        case 0:
            viewer->click(number(kWidth), number(kHeight), 1 + number(2));
            break;
        case 1:
            viewer->drag(number(kWidth), number(kHeight), number(kWidth), number(kHeight), 1 + number(2));
            break;
        case 2:
            viewer->wheel(number(6) - 3);
            break;
        case 3:
            viewer->resize(100 + number(kWidth), 100 + number(kHeight));
            break;
        default:
            viewer->keys({keys[static_cast<size_t>(number(static_cast<int>(keys.size()) - 1))]});
        }
        anonymous = std::max(anonymous, viewer->anonymousMiB());
    }
    ASSERT_TRUE(viewer->runs()) << viewer->output();
    // Measured with the same seed: 120 MiB at first, 199 after 300 steps, 262 after 760 and 275 after 1336,
    // so it grows more and more slowly. The bounds are a fifth above that; a leak per frame would pass them.
    constexpr int kFewSteps = 300;
    EXPECT_LT(anonymous, step <= kFewSteps ? 240 : 330)
        << "MiB of anonymous memory after " << step << " steps";
    viewer->keys({"Escape", "Escape"});
    viewer->resize(kWidth, kHeight);
    // With the scene as it is in its file, nothing is left of what edits had asked of the device.
    viewer->mark();
    ASSERT_TRUE(dropFile(display_->name(), viewer->windowId(), kScenes + "cornell_small.glb"));
    if (viewer->says("ask: ", 5)) viewer->keys({"d"});
    EXPECT_TRUE(viewer->says("scene: ", 60)) << viewer->output();
    // A pass that was asked for before may end in a pause.
    bool done = false;
    for (int tries = 0; tries < 240 && !done; ++tries) {
        done = viewer->says("bake: done", 1);
        if (!done && viewer->phase() == "paused") viewer->keys({"space"});
    }
    EXPECT_TRUE(done) << viewer->output();
    // The software device's memory is shared memory. Measured: 10.7 MiB where the scene was just opened, of
    // which 4 keep links. The bound of the rest is a fifth above that.
    constexpr double kBesideLinks = 8; // [MiB]
    EXPECT_LT(viewer->sharedMiB(), viewer->linksMiB() + kBesideLinks)
        << "MiB of device memory, of which " << viewer->linksMiB() << " keep links";
    quit(*viewer);
}

TEST(ViewerWithout, ADisplayNamesTheMend) {
    const TemporaryFolder home;
    ViewerProcess viewer(
        {.display = "", .home = home.path(""), .arguments = {"view", kScenes + "cornell_small.glb"}});
    EXPECT_EQ(viewer.ended(20), 1);
    EXPECT_TRUE(viewer.says("relume bake", 1)) << viewer.output();
    const std::string text = viewer.output();
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1) << text;
}

TEST(ViewerWithout, Opengl45NamesTheMend) {
    const VirtualDisplay display(640, 480);
    const TemporaryFolder home;
    setenv("MESA_GL_VERSION_OVERRIDE", "3.3", 1);
    ViewerProcess viewer({.display = display.name(),
                          .home = home.path(""),
                          .arguments = {"view", kScenes + "cornell_small.glb"}});
    unsetenv("MESA_GL_VERSION_OVERRIDE");
    EXPECT_EQ(viewer.ended(20), 1);
    EXPECT_TRUE(viewer.says("4.5", 1)) << viewer.output();
    EXPECT_TRUE(viewer.says("relume bake", 1)) << viewer.output();
}

TEST(ViewerWithout, VulkanShowsTheSceneAndSaysSo) {
    const VirtualDisplay display(640, 480);
    const TemporaryFolder home;
    setenv("VK_ICD_FILENAMES", "/nonexistent.json", 1);
    setenv("VK_DRIVER_FILES", "/nonexistent.json", 1);
    ViewerProcess viewer({.display = display.name(),
                          .home = home.path(""),
                          .arguments = {"view", kScenes + "cornell_small.glb", "--log-actions"}});
    unsetenv("VK_ICD_FILENAMES");
    unsetenv("VK_DRIVER_FILES");
    ASSERT_TRUE(viewer.window()) << viewer.output();
    EXPECT_TRUE(viewer.says("bake: failed")) << viewer.output();
    EXPECT_TRUE(viewer.says("Vulkan", 1)) << viewer.output();
    EXPECT_TRUE(viewer.says("middle: notice over scene")) << viewer.output();
    viewer.keys({"ctrl+q"});
    EXPECT_EQ(viewer.ended(10), 0) << viewer.output();
}

} // namespace
} // namespace relume
