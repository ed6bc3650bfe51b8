// Khronos' glTF validator has nothing to say about any GLB that the program writes.
#include "tests/gpu/relume_process.h"
#include "tests/temporary_folder.h"
#include "tests/text.h"
#include "tests/web/web_page.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace relume {
namespace {

const std::string kValidatedScenes = std::string(RELUME_SOURCE_DIR) + "/assets/scenes/";

class Validator : public testing::Test {
protected:
    void SetUp() override {
        if (const std::string why = whyNoPages(); !why.empty()) GTEST_SKIP() << why;
    }
    /// Writes a GLB of this name by these arguments, which name the file that they write.
    void writes(const std::string& name, std::vector<std::string> arguments) {
        files_.push_back(path(name));
        const ProcessResult run = runRelume(arguments);
        ASSERT_EQ(run.status, 0) << name << ": " << run.err;
    }
    std::string path(const std::string& name) const { return folder_.path(name); }

    const TemporaryFolder folder_;
    std::vector<std::string> files_;
};

TEST_F(Validator, HasNothingToSayAboutWhatCommandsWrite) {
    writes("made.glb", {"scene", "gallery", "-o", path("made.glb")});
    writes("unwrapped.glb",
           {"unwrap", path("made.glb"), "--all", "--size", "128", "-o", path("unwrapped.glb")});
    writes("edited.glb", {"edit", path("made.glb"), "-o", path("edited.glb"), "--add",
                          "point,name=P,intensity=9,position=0,2,0", "--add",
                          "spot,name=S,intensity=9,position=0,2,0", "--add", "directional,name=D,intensity=9",
                          "--add", "rectangle,name=R,intensity=9,position=1,2,0,size=1,0.5", "--add",
                          "disc,name=O,intensity=9,position=1,2,0,radius=0.2", "--add", "sky,intensity=5",
                          "--set", "Lamp 1.strength=7"});
    const std::vector<std::string> quick = {"--samples", "8", "--size", "128"};
    for (const char* scene : {"octagon", "raw"}) { // whose meshes get lightmap UVs
        std::vector<std::string> bake = {
            "bake",        kValidatedScenes + scene + ".glb", "-o", path("map.exr"), "--pages", "4",
            "--scene-out", path(std::string(scene) + ".glb")};
        bake.insert(bake.end(), quick.begin(), quick.end());
        writes(std::string(scene) + ".glb", bake);
    }
    std::ofstream(path("floor.mtl")) << "newmtl Paint\nKd 0.9 0.1 0.1\n";
    std::ofstream(path("floor.obj"))
        << "mtllib floor.mtl\nv 0 0 0\nv 2 0 0\nv 2 0 3\nv 0 0 3\nusemtl Paint\nf 4 3 2 1\n";
    writes("imported.glb", {"import", path("floor.obj"), "-o", path("imported.glb")});
    for (const char* engine :
         {"any", "three", "babylon", "playcanvas", "bevy", "godot", "unity", "blender"}) {
        std::vector<std::string> words = {"export", path("made.glb"), "--for", engine, "-o", path(engine)};
        words.insert(words.end(), quick.begin(), quick.end());
        writes(std::string(engine) + "/scene.glb", words);
    }
    EXPECT_EQ(complaintsAbout(files_), "");
}

TEST_F(Validator, HasSomethingToSayAboutABrokenFile) {
    std::string bytes = bytesOf(kValidatedScenes + "cornell_small.glb");
    const std::string before = "\"componentType\":5126";
    const size_t at = bytes.find(before);
    ASSERT_NE(at, std::string::npos);
    bytes.replace(at, before.size(), "\"componentType\":5926");
    std::ofstream(path("broken.glb"), std::ios::binary) << bytes;
    EXPECT_TRUE(contains(complaintsAbout({path("broken.glb")}), "VALUE_NOT_IN_LIST"));
}

} // namespace
} // namespace relume
