// A bake loses no file that was there, and keeps its result whatever happens to its place.
#include "assets/gltf/gltf.h"
#include "assets/images/float_image.h"
#include "assets/images/image_file.h"
#include "tests/gpu/bake_scene.h"
#include "tests/gpu/relume_process.h"
#include "tests/temporary_folder.h"
#include "tests/text.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <sys/stat.h>

#include <csignal>

#include <filesystem>
#include <fstream>
#include <future>
#include <sstream>

namespace relume {
namespace {

namespace fs = std::filesystem;
using Strings = std::vector<std::string>;

std::string contentOfFile(const std::string& path) {
    std::ostringstream text;
    text << std::ifstream(path, std::ios::binary).rdbuf();
    return text.str();
}

class FileSafety : public testing::Test {
protected:
    FileSafety() {
        SceneMaker maker(64);
        maker.box({0, 0, 0}, {glm::vec3(2, 0, 0), {0, 2, 0}, {0, 0, 2}}, maker.material(0.5f, 1.0f), 14);
        saveGlb(maker.scene(), scene_);
    }
    static Strings arguments(const std::string& scene, const Strings& more) {
        Strings all = {"bake", scene, "--size", "64", "--samples", "4"};
        all.insert(all.end(), more.begin(), more.end());
        return all;
    }
    ProcessResult bake(const Strings& more) const { return runRelume(arguments(scene_, more)); }
    std::string path(const std::string& name) const { return folder_.path(name); }

    const TemporaryFolder folder_;
    const std::string scene_ = folder_.path("room.glb");
};

} // namespace

TEST_F(FileSafety, FifosAndDevicesTakeABakesOutputs) {
    const std::string fifo = path("map.exr");
    ASSERT_EQ(mkfifo(fifo.c_str(), 0600), 0);
    auto read = std::async(std::launch::async, [&] { return contentOfFile(fifo); });
    const ProcessResult r = bake({"-o", fifo, "--json", "/dev/null", "--checkpoint", "/dev/null"});
    const std::string bytes = read.get();
    EXPECT_EQ(r.status, 0) << r.err;
    EXPECT_TRUE(fs::is_fifo(fifo));
    EXPECT_TRUE(fs::is_character_file("/dev/null"));
    ASSERT_EQ(bake({"-o", path("plain.exr")}).status, 0);
    EXPECT_TRUE(bytes == contentOfFile(path("plain.exr")));
    EXPECT_EQ(folder_.files(), (Strings{"map.exr", "plain.exr", "room.glb"}));
}

TEST_F(FileSafety, PrivateFilesStayPrivate) {
    const Strings names = {"map.exr", "map.json", "map.png", "out.glb"};
    for (const std::string& name : names) {
        std::ofstream(path(name)) << "older";
        fs::permissions(path(name), fs::perms(0600));
    }
    const ProcessResult r = bake({"-o", path("map.exr"), "--json", path("map.json"), "--picture",
                                  path("map.png"), "--scene-out", path("out.glb")});
    ASSERT_EQ(r.status, 0) << r.err;
    for (const std::string& name : names) {
        EXPECT_EQ(fs::status(path(name)).permissions(), fs::perms(0600)) << name;
        EXPECT_NE(contentOfFile(path(name)), "older") << name;
    }
}

TEST_F(FileSafety, AResultWhosePlaceIsTakenMeanwhileIsSaved) {
    const std::string map = path("map.exr");
    bool taken = false;
    const ProcessResult r = runRelume(arguments(scene_, {"-o", map}), [&](const std::string& err) {
        if (!taken && contains(err, " patches\n")) taken = fs::create_directory(map);
        return 0;
    });
    ASSERT_TRUE(taken) << r.err;
    EXPECT_EQ(r.status, 1) << r.err;
    const std::string words = "it was saved as '";
    ASSERT_TRUE(contains(r.err, words)) << r.err;
    const size_t from = r.err.find(words) + words.size();
    const std::string saved = r.err.substr(from, r.err.find('\'', from) - from);
    EXPECT_EQ(readImage(saved).width, 64u);
    fs::remove(saved);
}

TEST_F(FileSafety, NamesNeedNotBeUtf8) {
    const std::string folder = path("caf\xe9"), scene = folder + "/r\xff.glb", map = folder + "/m\xe9.exr";
    fs::create_directory(folder);
    fs::copy_file(scene_, scene);
    const ProcessResult r = runRelume(
        arguments(scene, {"-o", map, "--json", folder + "/s.json", "--scene-out", folder + "/o\xe9.glb"}));
    ASSERT_EQ(r.status, 0) << r.err;
    EXPECT_TRUE(contains(r.err, "wrote " + map)) << r.err;
    EXPECT_EQ(readImage(map).attributes.at("relume:scene"), "r\xff.glb");
    const auto json = nlohmann::json::parse(contentOfFile(folder + "/s.json"));
    EXPECT_EQ(json.at("scene"), path("caf\xef\xbf\xbd/r\xef\xbf\xbd.glb"));
    EXPECT_EQ(loadGltf(folder + "/o\xe9.glb").instances.size(), loadGltf(scene_).instances.size());
    const ProcessResult printed = runRelume(arguments(scene, {"-o", map, "--json", "-"}));
    EXPECT_EQ(printed.status, 0) << printed.err;
    EXPECT_TRUE(nlohmann::json::accept(printed.out));
}

TEST_F(FileSafety, StatisticsThatDoNotArriveAreAnError) {
    if (!fs::is_character_file("/dev/full")) GTEST_SKIP() << "there is no /dev/full";
    const ProcessResult r = runProgram(
        "/bin/sh", {"-c", "exec \"$0\" -q bake \"$1\" --size 64 --samples 4 -o \"$2\" --json - >/dev/full",
                    RELUME_BINARY, scene_, path("map.exr")});
    EXPECT_EQ(r.status, 1);
    EXPECT_TRUE(contains(r.err, "the standard output cannot be written")) << r.err;
    EXPECT_EQ(readImage(path("map.exr")).width, 64u);
}

TEST_F(FileSafety, ACheckpointMayGoOnInTheFileItCameFrom) {
    const std::string file = path("c");
    bool sent = false;
    const ProcessResult stopped =
        runRelume({"bake", scene_, "--size", "64", "--error", "1e-6", "-o", path("map.exr"), "--checkpoint",
                   file, "--checkpoint-every", "0.05"},
                  [&](const std::string& err) {
                      if (sent || !contains(err, " patches\n")) return 0;
                      sent = true;
                      return SIGINT;
                  });
    ASSERT_EQ(stopped.status, 1) << stopped.err;
    const ProcessResult wrong = bake({"-o", file, "--resume", file});
    EXPECT_NE(wrong.status, 0); // and it is still there
    const ProcessResult other = bake({"-o", path("map.exr"), "--checkpoint", file, "--resume", file});
    EXPECT_EQ(other.status, 1) << other.err; // of other settings, which is found in the file
    EXPECT_TRUE(contains(other.err, "belongs to a bake with other settings")) << other.err;
}

} // namespace relume
