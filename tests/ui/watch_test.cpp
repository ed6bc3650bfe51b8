// The viewer watches its file, and the file becomes what nobody expects.
#include "tests/text.h"
#include "tests/ui/glb_json.h"
#include "tests/ui/viewer_fixture.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>
#include <string>

namespace relume {
namespace {

using nlohmann::json;

json& node(json& document, const std::string& name) {
    for (json& node : document["nodes"])
        if (node.value("name", "") == name) return node;
    throw Error("no node " + name);
}

class ViewerWatch : public ViewerTest {
protected:
    const std::string good_ = bytesOf(kScenes + "cornell_small.glb");
    const std::string path_ = home_.path("level.glb");

    /// The file is another one at once, as by a program that saves well.
    void become(const std::string& bytes) {
        const std::string next = home_.path("next.glb");
        std::ofstream(next, std::ios::binary) << bytes;
        std::filesystem::rename(next, path_);
    }
    void becomeAndExpect(ViewerProcess& viewer, const std::string& bytes, const std::string& said) {
        viewer.mark();
        become(bytes);
        EXPECT_TRUE(viewer.says(said, 60)) << said << ": " << viewer.output();
        EXPECT_TRUE(viewer.runs()) << said << ": " << viewer.output();
    }
};

TEST_F(ViewerWatch, SurvivesWhateverItsFileBecomes) {
    become(good_);
    auto viewer = open({"view", path_, "--watch"});
    ASSERT_TRUE(viewer->says("bake: done", 240)) << viewer->output();

    const auto scaled = [&](const char* name, double scale) {
        return withJson(good_, [&](json& document) {
            json& object = node(document, name);
            object.erase("matrix");
            object["scale"] = {scale, scale, scale};
        });
    };
    // Beyond what Embree takes: such triangles are left out, the others are baked.
    becomeAndExpect(*viewer, scaled("Tall box", 1e19), "bake: done");
    becomeAndExpect(*viewer, scaled("Light", 1e20), "bake: done");
    becomeAndExpect(*viewer, "this is no glTF", "error: ");
    becomeAndExpect(*viewer, good_.substr(0, good_.size() / 2), "error: ");
    becomeAndExpect(*viewer, withJson(good_, [](json& document) { document.erase("meshes"); }), "error: ");
    becomeAndExpect(*viewer, good_, "bake: done");
    EXPECT_GT(mean(screenshot(*viewer)), 0.01) << "the picture is black";
    quit(*viewer);
}

TEST_F(ViewerWatch, ReadsAModelAnewWhoseLibraryOrPictureChanged) {
    const std::string model = home_.path("floor.obj"), library = home_.path("floor.mtl");
    std::ofstream(model) << "mtllib floor.mtl\nv 0 0 0\nv 2 0 0\nv 2 0 3\nv 0 0 3\nusemtl Paint\nf 4 3 2 1\n";
    std::ofstream(library) << "newmtl Paint\nKd 0.1 0.1 0.1\n";
    auto viewer = open({"view", model, "--watch"});
    ASSERT_TRUE(viewer->says("bake: done", 240)) << viewer->output();
    viewer->keys({"bracketleft", "3"}); // exposure by hand; the view of the albedo
    viewer->settle();
    const FloatImage dark = screenshot(*viewer);
    viewer->mark();
    std::ofstream(library) << "newmtl Paint\nKd 0.9 0.1 0.1\n";
    ASSERT_TRUE(viewer->says("scene: " + model, 60)) << viewer->output();
    ASSERT_TRUE(viewer->shows("bake: done", 240)) << viewer->output();
    EXPECT_GT(difference(dark, screenshot(*viewer)), 0.01) << "the new colour is seen";
    quit(*viewer);
}

} // namespace
} // namespace relume
