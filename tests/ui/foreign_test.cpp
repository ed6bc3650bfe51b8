// A scene that is no glTF file in the viewer: it opens, and is saved as a .glb.
#include "assets/gltf/gltf.h"
#include "tests/ui/viewer_fixture.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

namespace relume {
namespace {

class ViewerForeign : public ViewerTest {};

TEST_F(ViewerForeign, OpensAndIsSavedAsAGlb) {
    const std::string floor = home_.path("floor.obj");
    const std::string text = "v 0 0 0\nv 2 0 0\nv 2 0 3\nv 0 0 3\nf 4 3 2 1\n";
    std::ofstream(floor) << text;
    auto viewer = open({"view", floor, "--unwrap"});
    EXPECT_TRUE(viewer->says("scene: ", 60)) << viewer->output();
    viewer->keys({"ctrl+1"}); // a light
    EXPECT_TRUE(viewer->says("title: floor.obj* - Relume")) << viewer->output();
    viewer->keys({"ctrl+s"}); // which asks for another name
    viewer->settle();
    viewer->keys({"Return"});
    const std::string saved = home_.path("floor_edited.glb");
    EXPECT_TRUE(viewer->says("saved: " + saved)) << viewer->output();
    EXPECT_TRUE(viewer->shows("title: floor_edited.glb - Relume")) << viewer->output();
    const Scene scene = loadGltf(saved);
    EXPECT_EQ(scene.lights.size(), 1u);
    EXPECT_EQ(scene.instances.size(), 1u);
    std::ostringstream now;
    now << std::ifstream(floor).rdbuf();
    EXPECT_EQ(now.str(), text);
    quit(*viewer);
}

} // namespace
} // namespace relume
