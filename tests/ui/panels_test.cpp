// These tests type and choose in panels and dialogs.
#include "tests/ui/file_drop.h"
#include "tests/ui/viewer_fixture.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include <nlohmann/json.hpp>

namespace relume {
namespace {

class ViewerPanels : public ViewerTest {
protected:
    /// Types over what a field of numbers has, as one does after a click with Ctrl.
    static void typeInto(ViewerProcess& viewer, const Place& field, const std::string& text) {
        viewer.moveTo(field.first, field.second);
        viewer.settle();
        viewer.xdotool({"keydown", "ctrl"});
        viewer.settle();
        viewer.click(field.first, field.second);
        viewer.settle();
        viewer.xdotool({"keyup", "ctrl"});
        viewer.settle();
        viewer.press("ctrl+a");
        viewer.type(text);
        viewer.press("Return");
    }
    /// Returns what the viewer told last of the tiles that the camera sees.
    static std::string newestSeen(ViewerProcess& viewer) {
        const std::string text = viewer.output();
        const size_t at = text.rfind("seen: ");
        return at == std::string::npos ? "" : text.substr(at, text.find('\n', at) - at);
    }
};

// An angle of 1e39 is infinite: the light would be turned by no number, fail the bake, and fit in no file.
TEST_F(ViewerPanels, AnAngleThatIsInfiniteIsNone) {
    auto viewer = openConverged();
    viewer->press("alt+4");
    viewer->press("ctrl+2");
    EXPECT_TRUE(viewer->shows("badge: converged", 240)) << viewer->output();
    Place field = placeOf(*viewer, "Lights/Selected/Angles [deg]");
    field.first -= 60; // the first of three
    viewer->mark();
    typeInto(*viewer, field, "1e39");
    EXPECT_TRUE(viewer->says("edit: Rotation of Spot")) << viewer->output();
    EXPECT_TRUE(viewer->shows("badge: converged", 240)) << viewer->output();
    EXPECT_FALSE(viewer->says("bake: failed", 0)) << viewer->output();
    typeInto(*viewer, field, "30");
    EXPECT_TRUE(viewer->shows("badge: converged", 240)) << "the field is of use again: " << viewer->output();
    EXPECT_FALSE(viewer->says("bake: failed", 0)) << viewer->output();
    quit(*viewer);
}

// Exporters make names of whole paths.
TEST_F(ViewerPanels, ALongNameOfALightIsKept) {
    auto viewer = openConverged();
    viewer->press("alt+4");
    viewer->press("ctrl+1");
    EXPECT_TRUE(viewer->shows("badge: converged", 240)) << viewer->output();
    const Place field = placeOf(*viewer, "Lights/Selected/Name");
    const std::string name(150, 'n');
    viewer->click(field.first, field.second);
    viewer->press("ctrl+a");
    viewer->type(name);
    viewer->mark();
    viewer->press("Return");
    EXPECT_TRUE(viewer->says("edit: Name of Point")) << viewer->output();
    EXPECT_TRUE(viewer->says("item: Lights/" + name + "/Select ")) << viewer->output();
    quit(*viewer);
}

// The field of the dialog before lent its selection, and what was typed took the place of a part of the path.
TEST_F(ViewerPanels, APathThatIsTypedTakesThePlaceOfTheWholeOne) {
    auto viewer = openCornell();
    viewer->press("ctrl+o");
    viewer->press("Escape");
    viewer->press("ctrl+e");
    viewer->mark();
    viewer->type(home_.path("light.exr"));
    viewer->press("Return");
    EXPECT_TRUE(viewer->says("export: " + home_.path("light.exr\n"))) << viewer->output();
    EXPECT_TRUE(viewer->says("wrote " + home_.path("light.exr\n"), 60)) << viewer->output();
    quit(*viewer);
}

// What the camera sees is baked first, also where the camera was chosen and did not move by itself.
TEST_F(ViewerPanels, ACameraThatIsChosenTellsTheBakeWhatItSees) {
    auto viewer = open({"view", kScenes + "cornell_small.glb"});
    ASSERT_TRUE(viewer->says("seen: ", 120)) << viewer->output();
    ASSERT_TRUE(viewer->shows("bake: done", 240)) << viewer->output();
    const std::string first = newestSeen(*viewer);
    viewer->press("alt+3");
    viewer->mark();
    viewer->moveTo(700, 400);
    viewer->wheel(8); // close to what is in the middle
    ASSERT_TRUE(viewer->shows("seen: ")) << viewer->output();
    EXPECT_NE(newestSeen(*viewer), first);
    const Place camera = placeOf(*viewer, "Scene/Front");
    viewer->mark();
    viewer->click(camera.first, camera.second);
    EXPECT_TRUE(viewer->says(first)) << first << ": " << viewer->output();
    quit(*viewer);
}

TEST_F(ViewerPanels, AClickReadsTheErrorOfATexel) {
    auto viewer = openConverged();
    viewer->mark();
    viewer->click(640, 560);
    EXPECT_TRUE(viewer->shows("action: ")) << viewer->output();
    EXPECT_EQ(viewer->output().find("texel: "), std::string::npos) << "light is shown, no error";
    viewer->press("0");
    ASSERT_TRUE(viewer->shows("map: error", 60)) << viewer->output();
    viewer->mark();
    viewer->click(560, 600); // beside the gizmo of what is selected now
    ASSERT_TRUE(viewer->says("texel: ")) << viewer->output();
    const std::string text = viewer->output(), told = text.substr(text.rfind("texel: "));
    unsigned column = 0, row = 0;
    double percent = 0;
    ASSERT_EQ(std::sscanf(told.c_str(), "texel: %u %u: local error %lf %%", &column, &row, &percent), 3)
        << told;
    EXPECT_LT(column, 64u);
    EXPECT_LT(row, 64u);
    EXPECT_GT(percent, 0.0);
    EXPECT_LT(percent, 50.0) << "the bake has converged";
    quit(*viewer);
}

// A window that the monitor's scale had made larger was asked for as large again, and made larger once more.
TEST_F(ViewerPanels, AWindowKeepsItsSizeOnADisplayOfHighDensity) {
    const VirtualDisplay dense(kWidth, kHeight);
    ASSERT_TRUE(setDots(dense.name(), 192));
    const auto told = [&] {
        ViewerProcess viewer({.display = dense.name(), .home = home_.path(""), .arguments = {"view"}});
        EXPECT_TRUE(viewer.window()) << viewer.output();
        viewer.keys({"ctrl+q"});
        EXPECT_EQ(viewer.ended(10), 0) << viewer.output();
        std::ifstream file(home_.path("config/relume/preferences.json"));
        const auto kept = nlohmann::json::parse(file, nullptr, false);
        return kept.is_object() ? kept["window"].dump() : "";
    };
    const std::string once = told();
    EXPECT_NE(once, "");
    EXPECT_EQ(told(), once);
}

} // namespace
} // namespace relume
