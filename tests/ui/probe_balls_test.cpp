// The ball that is lit by its place, and the grid of light probes, in the viewer.
#include "tests/ui/viewer_fixture.h"

#include <gtest/gtest.h>

namespace relume {
namespace {

class ViewerBalls : public ViewerTest {};

TEST_F(ViewerBalls, ABallIsDraggedAndTheGridIsShown) {
    auto viewer = openConverged();
    const FloatImage before = screenshot(*viewer);

    viewer->mark();
    viewer->keys({"o"});
    EXPECT_TRUE(viewer->says("balls: ball, 0 in a grid")) << viewer->output();
    viewer->settle();
    const FloatImage ball = screenshot(*viewer);
    const double itself = difference(before, ball);
    EXPECT_GT(itself, 0.0002) << "it is there";
    EXPECT_LT(itself, 0.05) << "and the rest stays";

    // Its gizmo is that of objects.
    const Place up = placeOf(*viewer, "Gizmo/Y");
    viewer->mark();
    viewer->drag(up.first, up.second, up.first, up.second - 60);
    EXPECT_TRUE(viewer->says("action: move ball")) << viewer->output();
    EXPECT_TRUE(viewer->says("balls: ball, 0 in a grid, 0 of them inside walls, traced")) << viewer->output();
    viewer->settle();
    EXPECT_NEAR(placeOf(*viewer, "Gizmo/Y").second, up.second - 60, 4) << "it goes along with the cursor";
    EXPECT_GT(difference(ball, screenshot(*viewer)), 0.0002);
    EXPECT_EQ(viewer->output().find("edit: "), std::string::npos) << "it is no edit of the scene";

    // Less light reaches it without a ray.
    viewer->mark();
    viewer->keys({"shift+o"});
    EXPECT_TRUE(viewer->says(" in a grid, ")) << viewer->output();
    EXPECT_FALSE(viewer->output().find("balls: ball, 0 in") == std::string::npos);
    viewer->settle();
    const FloatImage grid = screenshot(*viewer);
    EXPECT_GT(difference(ball, grid), 0.002);

    viewer->keys({"o", "shift+o"});
    viewer->settle();
    EXPECT_LT(difference(before, screenshot(*viewer)), 1e-5) << "nothing is left of them";
    quit(*viewer);
}

} // namespace
} // namespace relume
