// The camera moves by itself while it is recorded.
#include "tests/text.h"
#include "tests/ui/glb_json.h"
#include "tests/ui/viewer_fixture.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <fstream>
#include <string>

namespace relume {
namespace {

using nlohmann::json;

class ViewerRecord : public ViewerTest {
protected:
    /// Gives the scene's camera an animation of 0.2 s. The buffer has two times and two places, as floats.
    static void animate(json& document) {
        json& buffers = document["buffers"];
        buffers.push_back({{"byteLength", 32},
                           {"uri", "data:application/octet-stream;base64,"
                                   "AAAAAM3MTD4AAAAAAACAPwAAQEAAAAAAAACAPwAAAEA="}});
        json &views = document["bufferViews"], &accessors = document["accessors"];
        for (const auto& [type, offset, bytes] : {std::tuple("SCALAR", 0, 8), {"VEC3", 8, 24}}) {
            views.push_back({{"buffer", buffers.size() - 1}, {"byteOffset", offset}, {"byteLength", bytes}});
            accessors.push_back(
                {{"bufferView", views.size() - 1}, {"componentType", 5126}, {"count", 2}, {"type", type}});
        }
        accessors[accessors.size() - 2].update({{"min", {0.0}}, {"max", {0.2}}});
        json& nodes = document["nodes"];
        size_t camera = 0;
        while (!nodes[camera].contains("camera"))
            ++camera;
        nodes[camera].erase("matrix");
        document["animations"] = {
            {{"samplers", {{{"input", accessors.size() - 2}, {"output", accessors.size() - 1}}}},
             {"channels", {{{"sampler", 0}, {"target", {{"node", camera}, {"path", "translation"}}}}}}}};
    }
    const std::string still_ = bytesOf(kScenes + "cornell_small.glb");
};

TEST_F(ViewerRecord, TheFilesAnimationOfACamera) {
    const std::string path = home_.path("moving.glb");
    std::ofstream(path, std::ios::binary) << withJson(still_, animate);
    auto viewer = open({"view", path});
    ASSERT_TRUE(viewer->says("bake: done", 240)) << viewer->output();
    viewer->mark();
    viewer->keys({"alt+shift+F12"});
    EXPECT_TRUE(viewer->says("(7 frames)", 60))
        << "30 pictures per second, and both ends: " << viewer->output();
    quit(*viewer);
}

TEST_F(ViewerRecord, AFileWithoutOneIsTold) {
    auto viewer = openCornell();
    viewer->mark();
    viewer->keys({"alt+shift+F12"});
    EXPECT_TRUE(viewer->says("note: the file has no animation that moves a camera")) << viewer->output();
    quit(*viewer);
}

} // namespace
} // namespace relume
