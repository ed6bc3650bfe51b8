// A level as it comes from elsewhere: without lightmap UVs and without light.
#include "assets/gltf/gltf.h"
#include "tests/gpu/relume_process.h"
#include "tests/ui/file_drop.h"
#include "tests/ui/viewer_fixture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

namespace relume {
namespace {

class ViewerLevel : public ViewerTest {
protected:
    /// The fixture's lightmaps are too small for a level.
    std::unique_ptr<ViewerProcess> openSized(const std::vector<std::string>& scene) {
        std::vector<std::string> arguments = {"view"};
        arguments.insert(arguments.end(), scene.begin(), scene.end());
        arguments.insert(arguments.end(), {"--log-actions", "--size", "512"});
        auto viewer = std::make_unique<ViewerProcess>(
            ViewerProcess::Desc{.display = display_->name(), .home = home_.path(""), .arguments = arguments});
        EXPECT_TRUE(viewer->window()) << viewer->output();
        return viewer;
    }
    void clickItem(ViewerProcess& viewer, const std::string& name) {
        const Place place = placeOf(viewer, name);
        viewer.mark();
        viewer.click(place.first, place.second);
    }
};

TEST_F(ViewerLevel, IsSeenAtOnceLitAndItsLightIsKept) {
    const std::string level = home_.path("raw.glb");
    std::filesystem::copy_file(kScenes + "raw.glb", level);
    ASSERT_TRUE(loadGltf(level).lights.empty());
    auto viewer = openSized({});
    ASSERT_TRUE(viewer->says("middle: start page")) << viewer->output();
    viewer->mark();
    ASSERT_TRUE(dropFile(display_->name(), viewer->windowId(), level));
    // Its geometry comes before its charts are made.
    ASSERT_TRUE(viewer->says("geometry: " + level, 60)) << viewer->output();
    EXPECT_TRUE(viewer->says("scene: " + level, 60)) << viewer->output();
    EXPECT_TRUE(viewer->says("furnished: lightmap UVs made, preview light: not in the file"))
        << viewer->output();
    EXPECT_TRUE(viewer->says("badge: refining", 240)) << viewer->output();
    viewer->settle();
    EXPECT_GT(mean(screenshot(*viewer)), 0.02) << "it is black";

    clickItem(*viewer, "Tabs/Lights");
    viewer->settle();
    clickItem(*viewer, "Lights/Keep");
    EXPECT_TRUE(viewer->says("edit: Keep of the preview light")) << viewer->output();
    viewer->mark();
    viewer->keys({"ctrl+s"});
    EXPECT_TRUE(viewer->says("saved: " + level, 60)) << viewer->output();
    quit(*viewer);

    const Scene kept = loadGltf(level);
    ASSERT_EQ(kept.lights.size(), 1u);
    EXPECT_EQ(kept.lights[0].name, "Sun");
    EXPECT_TRUE(kept.sky.shines());
    auto again = openSized({level});
    EXPECT_TRUE(again->says("furnished: lightmap UVs made: not in the file", 60)) << again->output();
    quit(*again);
}

// Three pages lie on one sheet in the viewer; the device that bakes is named by its number.
TEST_F(ViewerLevel, OfSeveralPagesIsBakedOnTheDeviceThatIsNamed) {
    const std::string level = home_.path("paged.glb");
    const ProcessResult made =
        runRelume({"bake", kScenes + "cornell_layers.glb", "-o", home_.path("map.exr"), "--size", "64",
                   "--pages", "3", "--samples", "16", "--scene-out", level});
    ASSERT_EQ(made.status, 0) << made.err;
    auto viewer = open({"view", level, "--bake-device", "0"});
    ASSERT_TRUE(viewer->shows("badge: converged", 240)) << viewer->output();
    const size_t end = made.err.find(" patches\n"), begin = made.err.rfind('\n', end) + 1;
    const std::string patches = made.err.substr(begin, end - begin) + " patches\n";
    EXPECT_NE(viewer->output().find("\n" + patches), std::string::npos) << patches << viewer->output();
    EXPECT_GT(mean(screenshot(*viewer)), 0.02) << "it is black";
    quit(*viewer);
}

} // namespace
} // namespace relume
