// Lights in the viewer: added by keys, set in the mix board, dragged by the gizmo, undone, compared.
#include "assets/gltf/gltf.h"
#include "assets/images/image_file.h"
#include "tests/ui/viewer_fixture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace relume {
namespace {

class ViewerLights : public ViewerTest {
protected:
    /// Mean difference of two pictures from one column to another, as shares of their width.
    static double differenceBetween(const FloatImage& a, const FloatImage& b, double from, double to) {
        double sum = 0;
        size_t count = 0;
        for (uint32_t y = 0; y < a.height; ++y)
            for (auto x = static_cast<uint32_t>(from * a.width); x < static_cast<uint32_t>(to * a.width); ++x)
                for (size_t c = 0; c < 3; ++c, ++count)
                    sum +=
                        std::abs(a.planes[c][size_t{y} * a.width + x] - b.planes[c][size_t{y} * a.width + x]);
        return sum / static_cast<double>(std::max<size_t>(count, 1));
    }
};

/// Suites of their own, which go beside the others.
class ViewerLightViews : public ViewerLights {};
class ViewerSky : public ViewerTest {};

TEST_F(ViewerLights, AreAddedSetDraggedAndUndone) {
    auto viewer = openConverged();
    const FloatImage before = screenshot(*viewer);
    edit(*viewer, "edit: Add Point", [&] { viewer->keys({"ctrl+1"}); });
    const FloatImage added = screenshot(*viewer);
    EXPECT_GT(mean(added) - mean(before), 0.005) << "another light";

    viewer->keys({"alt+4"});
    viewer->settle();
    const Place strength = placeOf(*viewer, "Lights/Point/Intensity");
    edit(*viewer, "edit: Intensity of Point",
         [&] { viewer->drag(strength.first, strength.second, strength.first + 50, strength.second); });
    const FloatImage stronger = screenshot(*viewer);
    EXPECT_GT(mean(stronger) - mean(added), 0.005);

    const Place up = placeOf(*viewer, "Gizmo/Y");
    edit(*viewer, "edit: Move Point", [&] { viewer->drag(up.first, up.second, up.first, up.second - 90); });
    const FloatImage moved = screenshot(*viewer);
    EXPECT_GT(difference(stronger, moved), 0.003);
    const Place lifted = placeOf(*viewer, "Gizmo/Y");
    EXPECT_NEAR(lifted.second, up.second - 90, 4) << "the gizmo goes along with the cursor";
    EXPECT_NEAR(lifted.first, up.first, 12);

    edit(*viewer, "action: Reset", [&] { viewer->keys({"ctrl+r"}); });
    EXPECT_LT(difference(moved, screenshot(*viewer)), 0.003) << "what a fresh bake gives";

    // One step each.
    edit(*viewer, "undo: Move Point", [&] { viewer->keys({"ctrl+z"}); });
    EXPECT_LT(difference(stronger, screenshot(*viewer)), 0.003);
    edit(*viewer, "undo: Intensity of Point", [&] { viewer->keys({"ctrl+z"}); });
    EXPECT_LT(difference(added, screenshot(*viewer)), 0.003);
    edit(*viewer, "undo: Add Point", [&] { viewer->keys({"ctrl+z"}); });
    EXPECT_LT(difference(before, screenshot(*viewer)), 0.003);
    quit(*viewer);
}

// Of nine lights, where there is memory for three layers at least and eight at most.
TEST_F(ViewerLights, BeyondTheMemoryTheyShareALayerAndThePanelSaysSo) {
    auto viewer = open({"view", kScenes + "cornell_small.glb", "--layer-memory", "400K"});
    EXPECT_TRUE(viewer->says("badge: converged", 240)) << viewer->output();
    viewer->keys({"alt+4"});
    EXPECT_FALSE(item(*viewer, "Lights/Shared layers"));
    for (int i = 0; i < 7; ++i)
        viewer->keys({"ctrl+1"});
    edit(*viewer, "edit: Add Point 8", [&] { viewer->keys({"ctrl+1"}); });
    EXPECT_NE(viewer->output().find("others share 'rest' ("), std::string::npos) << viewer->output();
    placeOf(*viewer, "Lights/Shared layers");
    quit(*viewer);
}

TEST_F(ViewerLights, ADragIsCancelledByEscape) {
    auto viewer = openConverged();
    edit(*viewer, "edit: Add Point", [&] { viewer->keys({"ctrl+1"}); });
    viewer->settle();
    const Place before = placeOf(*viewer, "Gizmo/X");
    viewer->mark();
    viewer->moveTo(before.first, before.second);
    viewer->xdotool({"mousedown", "1"});
    viewer->moveTo(before.first + 30, before.second);
    viewer->moveTo(before.first + 60, before.second);
    EXPECT_TRUE(viewer->says("edit: Move Point")) << viewer->output();
    viewer->keys({"Escape"});
    EXPECT_TRUE(viewer->says("action: drag cancelled")) << viewer->output();
    viewer->xdotool({"mouseup", "1"});
    viewer->settle();
    EXPECT_EQ(placeOf(*viewer, "Gizmo/X"), before);
    viewer->mark();
    viewer->keys({"ctrl+z"});
    EXPECT_TRUE(viewer->says("undo: Add Point")) << "no step of the drag stays: " << viewer->output();
    quit(*viewer);
}

TEST_F(ViewerLights, AreChosenByKeysAndIconsAndDeleted) {
    auto viewer = openConverged();
    viewer->keys({"ctrl+2"});
    EXPECT_TRUE(viewer->says("action: select light Spot")) << viewer->output();
    viewer->settle();
    viewer->mark();
    viewer->keys({"l"});
    EXPECT_TRUE(viewer->says("action: select light Light")) << "the emitter: " << viewer->output();
    const Place icon = placeOf(*viewer, "Icons/Spot");
    viewer->mark();
    viewer->click(icon.first, icon.second);
    EXPECT_TRUE(viewer->says("action: select light Spot")) << viewer->output();
    viewer->mark();
    viewer->keys({"alt+Right"});
    EXPECT_TRUE(viewer->says("edit: Position of Spot")) << viewer->output();
    viewer->mark();
    viewer->keys({"r", "alt+Right"});
    EXPECT_TRUE(viewer->says("edit: Rotation of Spot")) << viewer->output();
    viewer->mark();
    viewer->keys({"ctrl+d"});
    EXPECT_TRUE(viewer->says("action: select light Spot 2")) << viewer->output();
    viewer->mark();
    viewer->keys({"alt+m"});
    EXPECT_TRUE(viewer->says("edit: Mute of Spot 2")) << viewer->output();
    viewer->mark();
    viewer->keys({"Delete"});
    EXPECT_TRUE(viewer->says("edit: Delete Spot 2")) << viewer->output();
    EXPECT_TRUE(viewer->says("badge: converged", 240)) << viewer->output();
    quit(*viewer);
}

// A menu acts amid a frame, before the board is drawn.
TEST_F(ViewerLights, GoByMenusWhileTheBoardIsOpen) {
    auto viewer = open({"view", kScenes + "cornell_small.glb"});
    ASSERT_TRUE(viewer->shows("middle: scene", 60)) << viewer->output();
    const auto choose = [&](const std::string& menu, const std::string& name) {
        for (const std::string& item : {"Menu/" + menu, menu + "/" + name}) {
            viewer->settle();
            const Place place = placeOf(*viewer, item);
            viewer->mark();
            viewer->click(place.first, place.second);
        }
    };
    viewer->keys({"alt+4"});
    viewer->keys({"ctrl+1"});
    ASSERT_TRUE(viewer->says("action: select light Point")) << viewer->output();
    choose("Edit", "Undo");
    EXPECT_TRUE(viewer->shows("undo: Add Point")) << viewer->output();
    viewer->keys({"ctrl+1"});
    choose("Light", "Delete light");
    EXPECT_TRUE(viewer->shows("edit: Delete Point")) << viewer->output();
    quit(*viewer);
}

TEST_F(ViewerLights, KeepANameThatAClickElsewhereEnds) {
    auto viewer = open({"view", kScenes + "cornell_small.glb"});
    ASSERT_TRUE(viewer->shows("middle: scene", 60)) << viewer->output();
    viewer->keys({"alt+4", "ctrl+1"});
    ASSERT_TRUE(viewer->shows("action: select light Point")) << viewer->output();
    const auto type = [&](const std::string& text) {
        const Place field = placeOf(*viewer, "Lights/Selected/Name");
        viewer->click(field.first, field.second);
        viewer->settle();
        viewer->press("ctrl+a");
        viewer->press("BackSpace");
        viewer->type(text);
        viewer->settle();
        const Place strength = placeOf(*viewer, "Lights/Selected/Intensity");
        viewer->click(strength.first, strength.second);
    };
    viewer->mark();
    type("Lantern");
    EXPECT_TRUE(viewer->shows("edit: Name of Point")) << viewer->output();
    EXPECT_TRUE(item(*viewer, "Lights/Lantern/Intensity")) << "the board has it: " << viewer->output();
    viewer->mark();
    type("Lantern");
    viewer->settle();
    viewer->keys({"ctrl+z"});
    EXPECT_TRUE(viewer->says("undo: Name of Point")) << "the same name is no step: " << viewer->output();
    quit(*viewer);
}

TEST_F(ViewerLightViews, AWipeShowsTheLightBeforeTheEdit) {
    auto viewer = openConverged();
    const FloatImage before = screenshot(*viewer);
    edit(*viewer, "edit: Add Point", [&] { viewer->keys({"ctrl+1"}); });
    const FloatImage after = screenshot(*viewer);
    viewer->keys({"b"});
    viewer->settle();
    const FloatImage wiped = screenshot(*viewer);
    EXPECT_LT(differenceBetween(before, wiped, 0.0, 0.49), 0.002) << "left as it was";
    EXPECT_LT(differenceBetween(after, wiped, 0.51, 1.0), 0.002) << "right as it is";
    EXPECT_GT(differenceBetween(before, after, 0.0, 0.49), 0.005);
    // The line follows the mouse, from where that was pressed, not from where it was by the next frame.
    const Place line = placeOf(*viewer, "Wipe/Line");
    viewer->dragWhileItHangs(line.first, line.second, line.first + 230, line.second);
    viewer->settle();
    const FloatImage further = screenshot(*viewer);
    EXPECT_LT(differenceBetween(before, further, 0.0, 0.7), 0.002);
    viewer->mark();
    viewer->keys({"shift+b"}); // the light as it is becomes B
    viewer->settle();
    EXPECT_LT(difference(after, screenshot(*viewer)), 0.002);
    quit(*viewer);
}

TEST_F(ViewerSky, IsSeenBehindTheSceneAndMuted) {
    auto viewer = openConverged();
    viewer->moveTo(800, 400);
    viewer->wheel(-12); // so far away that there is nothing in the corners
    const auto corner = [](const FloatImage& image) {
        float sum = 0;
        for (size_t c = 0; c < 3; ++c)
            for (uint32_t y = 4; y < 8; ++y)
                sum += image.planes[c][size_t{y} * image.width + image.width - 5];
        return sum / 12.0f;
    };
    const FloatImage before = screenshot(*viewer);
    edit(*viewer, "edit: Add sky", [&] { viewer->keys({"ctrl+6"}); });
    const FloatImage lit = screenshot(*viewer);
    EXPECT_GT(corner(lit) - corner(before), 0.02f);
    edit(*viewer, "edit: Mute of Sky", [&] { viewer->keys({"alt+m"}); });
    const FloatImage muted = screenshot(*viewer);
    EXPECT_NEAR(corner(muted), corner(before), 0.002f);
    EXPECT_LT(difference(before, muted), 0.003) << "its light is gone, too";
    quit(*viewer);
}

TEST_F(ViewerLights, AreSavedAndAskedAboutBeforeTheyAreLost) {
    const std::string file = home_.path("scene.glb");
    std::filesystem::copy_file(kScenes + "cornell_small.glb", file);
    auto viewer = open({"view", file});
    ASSERT_TRUE(viewer->says("title: scene.glb - Relume")) << viewer->output();
    viewer->keys({"ctrl+1"});
    EXPECT_TRUE(viewer->says("title: scene.glb* - Relume")) << viewer->output();
    viewer->mark();
    viewer->keys({"ctrl+q"});
    EXPECT_TRUE(viewer->says("ask: scene.glb has edits")) << viewer->output();
    viewer->keys({"Escape"});
    viewer->settle();
    EXPECT_TRUE(viewer->runs());
    viewer->mark();
    viewer->keys({"ctrl+s"});
    EXPECT_TRUE(viewer->says("saved: " + file)) << viewer->output();
    EXPECT_TRUE(viewer->says("title: scene.glb - Relume")) << viewer->output();
    EXPECT_EQ(loadGltf(file).lights.at(0).name, "Point");
    // Another one is saved on the way out.
    viewer->mark();
    viewer->keys({"ctrl+2"});
    EXPECT_TRUE(viewer->says("title: scene.glb* - Relume")) << viewer->output();
    viewer->keys({"ctrl+q"});
    EXPECT_TRUE(viewer->says("ask: ")) << viewer->output();
    viewer->keys({"Return"});
    EXPECT_EQ(viewer->ended(10), 0) << viewer->output();
    EXPECT_EQ(loadGltf(file).lights.size(), 2u);
}

// No edit, and the same as solo shows.
TEST_F(ViewerLightViews, ShowOneAlone) {
    auto viewer = openConverged();
    edit(*viewer, "edit: Add Point", [&] { viewer->keys({"ctrl+1"}); });
    const FloatImage both = screenshot(*viewer);
    viewer->mark();
    viewer->keys({"alt+l"});
    EXPECT_TRUE(viewer->shows("map: layer complete")) << viewer->output();
    const FloatImage point = screenshot(*viewer);
    viewer->keys({"l"}); // the emitter
    viewer->settle();
    const FloatImage emitter = screenshot(*viewer);
    EXPECT_GT(difference(both, point), 0.01);
    EXPECT_GT(difference(both, emitter), 0.01);
    EXPECT_GT(difference(point, emitter), 0.01);
    viewer->mark();
    viewer->keys({"alt+l"});
    EXPECT_TRUE(viewer->shows("map: light complete")) << viewer->output();
    EXPECT_LT(difference(both, screenshot(*viewer)), 0.002);
    edit(*viewer, "edit: Solo of Light", [&] { viewer->keys({"alt+s"}); });
    EXPECT_LT(difference(emitter, screenshot(*viewer)), 0.003);
    quit(*viewer);
}

TEST_F(ViewerLightViews, HaveAPreviewOfWhatTheyLight) {
    auto viewer = openConverged();
    edit(*viewer, "edit: Add Point", [&] { viewer->keys({"ctrl+1"}); });
    viewer->keys({"alt+4"});
    viewer->settle();
    const auto look = [&](const char* name) {
        const Place middle = placeOf(*viewer, name);
        const FloatImage window = screenshot(*viewer, "shift+F12");
        std::vector<double> pixels;
        for (int y = middle.second - 15; y <= middle.second + 15; ++y)
            for (int x = middle.first - 30; x <= middle.first + 30; ++x)
                pixels.push_back(
                    window.planes[1][static_cast<size_t>(y) * window.width + static_cast<size_t>(x)]);
        return pixels;
    };
    // Flat before it is there.
    const auto isFlat = [](const std::vector<double>& pixels) {
        const auto [least, most] = std::minmax_element(pixels.begin(), pixels.end());
        return *most - *least < 0.1;
    };
    std::vector<std::vector<double>> seen;
    for (const char* name : {"Lights/Light/Preview", "Lights/Point/Preview"}) {
        viewer->mark();
        seen.push_back(look(name));
        while (isFlat(seen.back()) && viewer->shows("preview: drawn", 240)) {
            viewer->mark();
            seen.back() = look(name);
        }
        EXPECT_FALSE(isFlat(seen.back())) << name << ": " << viewer->output();
    }
    double off = 0;
    for (size_t i = 0; i < seen[0].size(); ++i)
        off += std::abs(seen[0][i] - seen[1][i]);
    EXPECT_GT(off / static_cast<double>(seen[0].size()), 0.02) << "each shows its own light";
    quit(*viewer);
}

TEST_F(ViewerSky, TakesAPicture) {
    const std::string file = home_.path("scene.glb"), picture = home_.path("sky.exr");
    std::filesystem::copy_file(kScenes + "cornell_small.glb", file);
    FloatImage image{.width = 16, .height = 8, .channels = {}, .planes = {}, .attributes = {}};
    for (const char* channel : {"R", "G", "B"}) {
        std::vector<float>& plane = image.add(channel);
        std::fill(plane.begin(), plane.begin() + 64, 40.0f); // the upper half
    }
    writeImage(picture, image);
    auto viewer = open({"view", file});
    EXPECT_TRUE(viewer->says("badge: converged", 240)) << viewer->output();
    viewer->keys({"bracketleft"});
    viewer->moveTo(800, 400);
    viewer->wheel(-12); // the room is closed: the sky is behind it
    edit(*viewer, "edit: Add sky", [&] { viewer->keys({"ctrl+6"}); });
    const FloatImage even = screenshot(*viewer);
    viewer->keys({"alt+4"});
    viewer->settle();
    const auto choose = [&](const std::string& name) {
        const Place button = placeOf(*viewer, "Lights/Selected/Choose picture");
        viewer->click(button.first, button.second);
        // The field takes the keyboard with its second frame.
        EXPECT_TRUE(viewer->shows("action: Choose the sky's picture")) << viewer->output();
        viewer->keys({"ctrl+a", "BackSpace"});
        viewer->type(name);
        viewer->keys({"Return"});
    };
    viewer->mark();
    choose(home_.path("none.exr"));
    EXPECT_TRUE(viewer->shows("error: " + home_.path("none.exr"))) << viewer->output();
    edit(*viewer, "edit: Picture of the sky", [&] { choose(picture); });
    EXPECT_GT(difference(even, screenshot(*viewer)), 0.005) << "from above, and of another strength";
    viewer->mark();
    viewer->keys({"ctrl+s"});
    EXPECT_TRUE(viewer->says("saved: " + file)) << viewer->output();
    const Sky saved = loadGltf(file).sky;
    EXPECT_EQ(std::filesystem::path(saved.file).filename(), "sky.exr");
    EXPECT_EQ(saved.width, 16u);
    viewer->settle();
    const Place none = placeOf(*viewer, "Lights/Selected/No picture");
    edit(*viewer, "edit: Sky without a picture", [&] { viewer->click(none.first, none.second); });
    edit(*viewer, "undo: Sky without a picture", [&] { viewer->keys({"ctrl+z"}); });
    edit(*viewer, "undo: Picture of the sky", [&] { viewer->keys({"ctrl+z"}); });
    EXPECT_LT(difference(even, screenshot(*viewer)), 0.003);
    quit(*viewer);
}

TEST_F(ViewerSky, IsShownWhereItsPictureIsWiderThanOpenglTakes) {
    constexpr uint32_t kWide = 40000; // drivers take 16384 or 32768
    FloatImage image{.width = kWide, .height = 2, .channels = {}, .planes = {}, .attributes = {}};
    for (const char* channel : {"R", "G", "B"}) {
        std::vector<float>& plane = image.add(channel);
        std::fill(plane.begin(), plane.end(), 40.0f);
    }
    writeImage(home_.path("wide.exr"), image);
    auto viewer = open({"view", kScenes + "cornell_small.glb"});
    ASSERT_TRUE(viewer->shows("middle: scene", 60)) << viewer->output();
    viewer->keys({"alt+4", "ctrl+6"});
    EXPECT_TRUE(viewer->shows("edit: Add sky")) << viewer->output();
    const Place button = placeOf(*viewer, "Lights/Selected/Choose picture");
    viewer->mark();
    viewer->click(button.first, button.second);
    EXPECT_TRUE(viewer->shows("action: Choose the sky's picture")) << viewer->output();
    viewer->keys({"ctrl+a", "BackSpace"});
    viewer->type(home_.path("wide.exr"));
    viewer->mark();
    viewer->keys({"Return"});
    EXPECT_TRUE(viewer->says("edit: Picture of the sky", 60)) << viewer->output();
    viewer->settle();
    EXPECT_TRUE(viewer->runs());
    quit(*viewer);
}

// What was saved as another file is that file from then on.
TEST_F(ViewerLights, AreSavedAsAnotherFile) {
    const std::string first = home_.path("first.glb"), second = home_.path("second.glb");
    std::filesystem::copy_file(kScenes + "cornell_small.glb", first);
    auto viewer = open({"view", first});
    EXPECT_TRUE(viewer->says("scene: ", 60)) << viewer->output();
    viewer->keys({"ctrl+b", "ctrl+1"});
    EXPECT_TRUE(viewer->says("title: first.glb* - Relume")) << viewer->output();
    viewer->keys({"ctrl+shift+s"});
    viewer->settle();
    viewer->keys({"ctrl+a"});
    viewer->type(second);
    viewer->keys({"Return"});
    EXPECT_TRUE(viewer->says("saved: " + second)) << viewer->output();
    EXPECT_TRUE(viewer->shows("title: second.glb - Relume")) << viewer->output();
    viewer->mark();
    viewer->keys({"ctrl+2"});
    EXPECT_TRUE(viewer->says("title: second.glb* - Relume")) << viewer->output();
    viewer->keys({"ctrl+s"});
    EXPECT_TRUE(viewer->says("saved: " + second)) << viewer->output();
    EXPECT_EQ(loadGltf(second).lights.size(), 2u);
    EXPECT_EQ(loadGltf(first).lights.size(), 0u);
    // Its bookmarks, and what is offered for an export.
    viewer->keys({"alt+3"});
    viewer->settle();
    placeOf(*viewer, "Scene/bookmark 1");
    viewer->mark();
    viewer->keys({"ctrl+e"});
    // The field takes the keyboard with its second frame.
    EXPECT_TRUE(viewer->shows("action: Export lightmap")) << viewer->output();
    viewer->keys({"Return"});
    EXPECT_TRUE(viewer->says("export: " + home_.path("second_lightmap.exr"))) << viewer->output();
    quit(*viewer);
}

} // namespace
} // namespace relume
