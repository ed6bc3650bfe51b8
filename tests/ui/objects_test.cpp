// Objects in the viewer: dragged by the gizmo, nudged, hidden, undone, saved.
#include "assets/gltf/gltf.h"
#include "tests/ui/viewer_fixture.h"

#include <gtest/gtest.h>

#include <filesystem>

namespace relume {
namespace {

class ViewerObjects : public ViewerTest {
protected:
    static constexpr int kBox = 7; // of cornell_small.glb: the tall one
    static constexpr Place kOnBox{700, 500};

    /// A copy of the scene, with the tall box selected.
    std::unique_ptr<ViewerProcess> openWithBox() {
        std::filesystem::copy_file(kScenes + "cornell_small.glb", file_);
        auto viewer = open({"view", file_});
        EXPECT_TRUE(viewer->says("badge: converged", 240)) << viewer->output();
        viewer->keys({"bracketleft"}); // exposure by hand
        viewer->click(kOnBox.first, kOnBox.second);
        EXPECT_TRUE(viewer->says("action: select 7")) << viewer->output();
        viewer->settle();
        return viewer;
    }
    glm::vec3 savedPlace() const { return glm::vec3(loadGltf(file_).instances.at(kBox).transform[3]); }

    const std::string file_ = home_.path("scene.glb");
};

TEST_F(ViewerObjects, AreDraggedNudgedHiddenAndUndone) {
    auto viewer = openWithBox();
    const FloatImage before = screenshot(*viewer);
    const Place up = placeOf(*viewer, "Gizmo/Y");
    edit(*viewer, "edit: Move Tall box",
         [&] { viewer->drag(up.first, up.second, up.first, up.second - 60); });
    const FloatImage lifted = screenshot(*viewer);
    EXPECT_GT(difference(before, lifted), 0.005);
    EXPECT_NEAR(placeOf(*viewer, "Gizmo/Y").second, up.second - 60, 4) << "the gizmo goes along";
    edit(*viewer, "edit: Rotation of Tall box", [&] { viewer->keys({"r", "alt+Right"}); });
    const FloatImage turned = screenshot(*viewer);
    EXPECT_GT(difference(lifted, turned), 0.001);
    edit(*viewer, "edit: Hide Tall box", [&] { viewer->keys({"h"}); });
    const FloatImage hidden = screenshot(*viewer);
    EXPECT_GT(difference(turned, hidden), 0.005);
    edit(*viewer, "edit: Show all objects", [&] { viewer->keys({"alt+h"}); });
    EXPECT_LT(difference(turned, screenshot(*viewer)), 0.002);
    for (const char* name : {"Show all objects", "Hide Tall box", "Rotation of Tall box"})
        edit(*viewer, std::string("undo: ") + name, [&] { viewer->keys({"ctrl+z"}); });
    EXPECT_LT(difference(lifted, screenshot(*viewer)), 0.002);
    edit(*viewer, "undo: Move Tall box", [&] { viewer->keys({"ctrl+z"}); });
    EXPECT_LT(difference(before, screenshot(*viewer)), 0.002);
    quit(*viewer);
}

// The key is let go of while the gizmo is held.
TEST_F(ViewerObjects, AFlightEndsWhileTheGizmoIsHeld) {
    auto viewer = openWithBox();
    const Place up = placeOf(*viewer, "Gizmo/Y");
    viewer->mark();
    viewer->moveTo(up.first, up.second);
    viewer->xdotool({"keydown", "w", "mousedown", "1"});
    EXPECT_TRUE(viewer->says("action: fly")) << viewer->output();
    viewer->moveTo(up.first, up.second - 30);
    EXPECT_TRUE(viewer->says("edit: Move Tall box")) << "it was to be held: " << viewer->output();
    viewer->xdotool({"keyup", "w", "mouseup", "1"});
    viewer->mark();
    viewer->keys({"i"});
    EXPECT_TRUE(viewer->shows("action: Light icons", 60)) << "the camera stands: " << viewer->output();
    quit(*viewer);
}

// In a view without light nothing but the geometry can differ.
TEST_F(ViewerObjects, AreDrawnWhereTheyAreBeforeTheBakeFollows) {
    auto viewer = openWithBox();
    viewer->keys({"shift+0"}); // instances, each in a colour
    const FloatImage before = screenshot(*viewer);
    const Place right = placeOf(*viewer, "Gizmo/X");
    viewer->mark();
    viewer->moveTo(right.first, right.second);
    viewer->xdotool({"mousedown", "1"});
    viewer->moveTo(right.first + 30, right.second);
    viewer->moveTo(right.first + 60, right.second);
    EXPECT_TRUE(viewer->says("edit: Move Tall box")) << viewer->output();
    viewer->keys({"Escape"});
    EXPECT_TRUE(viewer->says("action: drag cancelled")) << viewer->output();
    viewer->xdotool({"mouseup", "1"});
    EXPECT_LT(difference(before, screenshot(*viewer)), 1e-6);
    viewer->mark();
    viewer->keys({"alt+Right", "alt+Right", "space"}); // paused: no light follows
    EXPECT_TRUE(viewer->says("edit: Position of Tall box")) << viewer->output();
    EXPECT_GT(difference(before, screenshot(*viewer)), 0.001);
    viewer->keys({"h"});
    viewer->settle();
    viewer->mark();
    viewer->click(kOnBox.first, kOnBox.second);
    EXPECT_TRUE(viewer->says("action: select ")) << viewer->output();
    EXPECT_FALSE(viewer->says("action: select 7", 0.5)) << "what is hidden cannot be clicked";
    quit(*viewer);
}

TEST_F(ViewerObjects, AreSetInThePanelAndSaved) {
    auto viewer = openWithBox();
    const glm::vec3 before = savedPlace();
    viewer->keys({"alt+3"});
    viewer->settle();
    const Place place = placeOf(*viewer, "Scene/Object/Position [m]"); // its middle: y
    viewer->mark();
    viewer->drag(place.first, place.second, place.first + 50, place.second);
    EXPECT_TRUE(viewer->says("edit: Position of Tall box")) << viewer->output();
    const Place hidden = placeOf(*viewer, "Scene/Object/Hidden");
    viewer->click(hidden.first, hidden.second);
    EXPECT_TRUE(viewer->says("edit: Hide Tall box")) << viewer->output();
    viewer->mark();
    viewer->keys({"ctrl+s"});
    EXPECT_TRUE(viewer->says("saved: " + file_)) << viewer->output();
    const glm::vec3 after = savedPlace();
    EXPECT_GT(after.y - before.y, 0.02f);
    EXPECT_EQ(after.x, before.x);
    EXPECT_EQ(after.z, before.z);
    quit(*viewer);
}

} // namespace
} // namespace relume
