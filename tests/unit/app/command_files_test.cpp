#include "app/offline/command_files.h"

#include "assets/base/error.h"
#include "assets/gltf/file/gltf_links.h"
#include "tests/temporary_folder.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace relume {
namespace {

namespace fs = std::filesystem;

class CommandFilesTest : public testing::Test {
protected:
    std::string path(const std::string& name) const { return folder_.path(name); }
    std::string make(const std::string& name, const std::string& text = "x") const {
        fs::create_directories(fs::path(path(name)).parent_path());
        std::ofstream(path(name)) << text;
        return path(name);
    }
    /// Returns the clash of "--output" with a file that is read.
    std::string clash(const std::string& read, const std::string& written) const {
        return CommandFiles().reads("SCENE", read).writes("--output", written).clash();
    }
    std::string clashOfTwo(const std::string& first, const std::string& second) const {
        return CommandFiles().writes("--output", first).writes("--json", second).clash();
    }

    const TemporaryFolder folder_;
};

TEST_F(CommandFilesTest, FindsAFileThatIsReadAndWritten) {
    const std::string scene = make("s.glb");
    fs::create_hard_link(scene, path("hard.glb"));
    fs::create_symlink("s.glb", path("soft.glb"));
    fs::create_directories(path("sub"));
    fs::create_symlink(folder_.path(), path("sub/back"));
    for (const std::string& same : {scene, path("./s.glb"), path("sub/../s.glb"), path("hard.glb"),
                                    path("soft.glb"), path("sub/back/s.glb")})
        EXPECT_NE(clash(scene, same), "") << same;
    EXPECT_EQ(clash(scene, path("other.glb")), "");
    EXPECT_EQ(clash(scene, path("sub/s.glb")), "");
    EXPECT_EQ(clash(scene, scene),
              "--output would replace '" + scene + "', which SCENE names: give --output another name");
}

TEST_F(CommandFilesTest, FindsAFileThatIsWrittenTwice) {
    fs::create_directories(path("sub"));
    fs::create_symlink(folder_.path(), path("link"));
    fs::create_symlink("o.exr", path("dangling"));
    const std::string missing = path("o.exr");
    for (const std::string& same :
         {missing, path("./o.exr"), path("sub/../o.exr"), path("link/o.exr"), path("dangling")})
        EXPECT_NE(clashOfTwo(missing, same), "") << same;
    EXPECT_EQ(clashOfTwo(missing, path("p.exr")), "");
    EXPECT_EQ(clashOfTwo(missing, path("sub/o.exr")), "");
    EXPECT_EQ(clashOfTwo(path("nowhere/o.exr"), path("nowhere/o.exr")), ""); // another error tells of it
    EXPECT_EQ(clashOfTwo(missing, path("./o.exr")), "--output and --json are one file, '" + missing +
                                                        "', which is '" + path("./o.exr") +
                                                        "': give one of them another name");
}

TEST_F(CommandFilesTest, LeavesOutWhatIsNoFile) {
    EXPECT_EQ(clashOfTwo("", ""), "");
    EXPECT_EQ(clashOfTwo("-", "-"), "");
    EXPECT_EQ(clashOfTwo("/dev/null", "/dev/null"), "");
}

TEST_F(CommandFilesTest, AllowsWhatIsMeant) {
    const std::string file = make("a");
    CommandFiles files;
    files.reads("--resume", file).writes("--checkpoint", file);
    EXPECT_NE(files.clash(), "");
    EXPECT_THROW(files.check(), UsageError);
    files.mayBe("--checkpoint", "--resume");
    EXPECT_EQ(files.clash(), "");
    files.check();
    files.writes("--output", file);
    EXPECT_NE(files.clash(), "");
}

TEST_F(CommandFilesTest, KnowsWhatBelongsToAScene) {
    const std::string scene = make("room/s.gltf", R"({
        "buffers": [{"uri": "my%20data.bin"}, {"uri": "data:application/octet-stream;base64,AAAA"}],
        "images": [{"uri": "sub/wall.png"}, {"uri": "https://example.com/x.png"}, {"bufferView": 0}],
        "textures": [{"extensions": {"SOME_images": {"image": {"uri": "other.webp"}}}}],
        "scenes": [{"extras": {"relume": {"sky": {"file": "../sky.exr"}}, "uri": "mine"}}]})");
    const std::vector<std::string> expected = {path("room/my data.bin"), path("room/sub/wall.png"),
                                               path("room/other.webp"), path("room/../sky.exr")};
    EXPECT_EQ(linkedFiles(scene), expected);
    make("sky.exr");
    fs::create_directories(path("room/sub"));
    const auto clashOf = [&](const std::string& written) {
        return CommandFiles().readsScene("SCENE", scene).writes("--output", written).clash();
    };
    for (const std::string& own : expected)
        EXPECT_NE(clashOf(own), "") << own;
    EXPECT_NE(clashOf(path("sky.exr")).find("a file of SCENE"), std::string::npos);
    EXPECT_EQ(clashOf(path("room/mine")), "");
    // A scene may be saved into itself, but not into one of its files.
    CommandFiles edit;
    edit.readsScene("SCENE", scene).mayBe("--output", "SCENE").writes("--output", path("sky.exr"));
    EXPECT_NE(edit.clash(), "");
}

TEST_F(CommandFilesTest, KnowsWhatAModelNames) {
    const std::string model = make("house.obj", "mtllib paints.mtl\nv 0 0 0\n");
    make("paints.mtl", "newmtl Wall\nmap_Kd textures\\Red Wall.png\n");
    make("textures/red wall.png");
    make("textures/other.png");
    const auto clash = [&](const std::string& written) {
        return CommandFiles().readsScene("SCENE", model).writes("--output", path(written)).clash();
    };
    EXPECT_EQ(clash("paints.mtl"), "--output would replace '" + path("paints.mtl") +
                                       "', a file of SCENE: give --output another name");
    EXPECT_NE(clash("textures/red wall.png"), "");
    EXPECT_EQ(clash("textures/other.png"), "");
    EXPECT_THROW(CommandFiles().readsScene("SCENE", model).writes("--output", path("paints.mtl")).check(),
                 UsageError);
}

TEST_F(CommandFilesTest, ReadsTheSceneOfABinaryFile) {
    const std::string json = R"({"images": [{"uri": "a.png"}]} )";
    const auto word = [](uint32_t value) { return std::string(reinterpret_cast<const char*>(&value), 4); };
    const std::string head = "glTF" + word(2) + word(1000) + word(uint32_t(json.size())) + "JSON";
    EXPECT_EQ(linkedFiles(make("s.glb", head + json + "more")), std::vector{path("a.png")});
    EXPECT_TRUE(linkedFiles(make("cut.glb", head + json.substr(1))).empty());
    EXPECT_TRUE(linkedFiles(make("no.gltf", "this \"uri\" is no scene")).empty());
    EXPECT_TRUE(linkedFiles(path("missing.glb")).empty());
    EXPECT_TRUE(linkedFiles("/dev/zero").empty());
}

TEST_F(CommandFilesTest, FramesTakeAFolder) {
    const std::string scene = make("s.gltf", R"({"images": [{"uri": "frames/frame_0002.png"}]})");
    make("frames/frame_0002.png");
    const auto clashOf = [&](const std::string& folder) {
        return CommandFiles().readsScene("SCENE", scene).writesFrames("--output", folder).clash();
    };
    EXPECT_NE(clashOf(path("frames")), "");
    EXPECT_NE(clashOf(path("frames/")), "");
    EXPECT_EQ(clashOf(path("others")), "");
    EXPECT_EQ(clashOf(folder_.path()), "");
}

} // namespace
} // namespace relume
