// This runs `relume shot` as a user does: pictures of the scenes that ship are held against those kept in
// tests/golden, and it checks what is refused.
#include "app/text/heat_map.h"
#include "app/viewer/state/preferences.h"
#include "assets/gltf/gltf.h"
#include "assets/images/float_image.h"
#include "assets/images/image_file.h"
#include "assets/images/metrics.h"
#include "tests/gpu/bake_scene.h"
#include "tests/gpu/relume_process.h"
#include "tests/temporary_folder.h"
#include "tests/text.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

namespace relume {
namespace {

using Strings = std::vector<std::string>;

ProcessResult shot(Strings arguments) {
    arguments.insert(arguments.begin(), {"-q", "shot"});
    const char* device = std::getenv("RELUME_TEST_DEVICE");
    if (device != nullptr) arguments.insert(arguments.end(), {"--device", device});
    return runRelume(arguments);
}

/// Sets an environment variable for the programs a test starts.
class Environment {
public:
    Environment(const char* name, const char* value) : name_(name) { setenv(name, value, 1); }
    ~Environment() { unsetenv(name_); }
    Environment(const Environment&) = delete;
    Environment& operator=(const Environment&) = delete;

private:
    const char* name_;
};

class GoldenShot : public testing::TestWithParam<const char*> {};

// RELUME_UPDATE_GOLDEN=1 takes the pictures as they are now.
TEST_P(GoldenShot, LooksAsItDid) {
    const std::string name = GetParam(), file = name + ".png";
    const std::string golden = std::string(RELUME_SOURCE_DIR) + "/tests/golden/" + file;
    const std::string folder = RELUME_GOLDEN_DIR; // of the build: what failed stays there to be looked at
    std::filesystem::create_directories(folder);
    const std::string made = folder + "/" + file;
    const ProcessResult run = shot({std::string(RELUME_SOURCE_DIR) + "/assets/scenes/" + name + ".glb", "-o",
                                    made, "--size", "320x180", "--lightmap-size", "128", "--samples", "64"});
    ASSERT_EQ(run.status, 0) << run.err;
    if (std::getenv("RELUME_UPDATE_GOLDEN") != nullptr) {
        std::filesystem::copy_file(made, golden, std::filesystem::copy_options::overwrite_existing);
        GTEST_SKIP() << "updated " << golden;
    }
    const FloatImage a = readImage(made), b = readImage(golden);
    const ImagePair pair({a, made}, {b, golden});
    const std::vector<float> difference = pair.flipDifferences(67.0);
    // Another tracer or OpenGL driver moves noise and edges by less; a wrong exposure, filter or material by
    // more.
    constexpr double kTolerance = 0.02;
    EXPECT_LT(pair.mean(difference), kTolerance) << "see " << folder << "/" << name << "_difference.png";
    if (HasFailure())
        writeImage(folder + "/" + name + "_difference.png",
                   heatMap(a.width, difference, pair.covered(), 1.0));
}

INSTANTIATE_TEST_SUITE_P(Scenes, GoldenShot, testing::Values("cornell_geom", "cornell_statue", "gallery"),
                         [](const auto& scene) { return std::string(scene.param); });

class ShotCommand : public testing::Test {
protected:
    ShotCommand() {
        SceneMaker maker(64);
        maker.box({0, 0, 0}, {glm::vec3(2, 0, 0), {0, 2, 0}, {0, 0, 2}}, maker.material(0.5f, 0.25f), 14);
        saveGlb(maker.scene(), scene_);
    }
    std::string path(const std::string& name) const { return folder_.path(name); }
    ProcessResult shoot(Strings more) const {
        more.insert(more.begin(),
                    {scene_, "-o", path("shot.png"), "--size", "64x32", "--lightmap-size", "64"});
        return shot(more);
    }
    void expectNoPicture() const { EXPECT_EQ(folder_.files(), Strings{"room.glb"}); }

    TemporaryFolder folder_;
    const std::string scene_ = folder_.path("room.glb");
};

// A closed furnace of albedo 1/2 has radiance emission / (1 - 1/2) everywhere; the camera it finds by itself
// stands inside.
TEST_F(ShotCommand, ShowsAFurnaceInItsRadiance) {
    const ProcessResult run = shoot({"--tone", "none", "--exposure", "0", "--samples", "256"});
    ASSERT_EQ(run.status, 0) << run.err;
    const FloatImage image = readImage(path("shot.png"));
    ASSERT_EQ(image.width, 64u);
    ASSERT_EQ(image.height, 32u);
    for (const std::vector<float>& plane : image.planes)
        for (const float value : plane)
            ASSERT_NEAR(value, 0.5f, 0.02f);
    EXPECT_EQ(folder_.files(), (Strings{"room.glb", "shot.png"}));
}

TEST_F(ShotCommand, TakesALightmapThatWasBaked) {
    ASSERT_EQ(
        runRelume({"-q", "bake", scene_, "-o", path("room.exr"), "--size", "64", "--samples", "64"}).status,
        0);
    const Strings arguments = {scene_, "-o", path("a.png"), "--size", "64x32"};
    Strings given = arguments, baked = arguments;
    given.insert(given.end(), {"--lightmap", path("room.exr")});
    baked[2] = path("b.png");
    baked.insert(baked.end(), {"--lightmap-size", "64", "--samples", "64"});
    ASSERT_EQ(shot(given).status, 0);
    ASSERT_EQ(shot(baked).status, 0);
    EXPECT_EQ(compareImages(readImage(path("a.png")), "a", readImage(path("b.png")), "b").maximum, 0.0);
}

TEST_F(ShotCommand, RefusesALightmapOfRadiance) {
    const std::string lightmap = path("radiance.exr");
    ASSERT_EQ(runRelume({"-q", "bake", scene_, "-o", lightmap, "--size", "64", "--samples", "16",
                         "--quantity", "radiance"})
                  .status,
              0);
    const ProcessResult run = shot({scene_, "-o", path("shot.png"), "--lightmap", lightmap});
    EXPECT_EQ(run.status, 1);
    EXPECT_TRUE(contains(run.err, "radiance.exr: holds radiance")) << run.err;
}

TEST_F(ShotCommand, NeedsNoBakeToShowGeometry) {
    for (const char* view : {"albedo", "normal", "material", "instance", "checker", "density", "emission"}) {
        const ProcessResult run = shoot({"--view", view, "--device", "nosuchdevice"});
        EXPECT_EQ(run.status, 0) << view << ": " << run.err;
    }
}

TEST_F(ShotCommand, TellsWhichCamerasThereAre) {
    const ProcessResult run = shoot({"--camera", "Nowhere"});
    EXPECT_EQ(run.status, 1);
    EXPECT_TRUE(contains(run.err, "has no camera 'Nowhere': it has none, use --eye and --target")) << run.err;
    expectNoPicture();
}

TEST_F(ShotCommand, RefusesWrongUsage) {
    const std::vector<Strings> wrong = {{"--eye", "1,1,1"},
                                        {"--eye", "1,1,1", "--target", "1,1,1"},
                                        {"--eye", "1,1", "--target", "0,0,0"},
                                        {"--camera", "A", "--eye", "1,1,1", "--target", "0,0,0"},
                                        {"--view", "nosuchview"},
                                        {"--tone", "nosuchtone"},
                                        {"--filter", "nosuchfilter"},
                                        {"--exposure", "bright"},
                                        {"--lightmap", "room.exr"}}; // beside --lightmap-size
    for (const Strings& arguments : wrong) {
        const ProcessResult run = shoot(arguments);
        EXPECT_EQ(run.status, 2) << arguments[0] << ": " << run.err;
    }
    EXPECT_EQ(shot({scene_, "-o", path("shot.jpg")}).status, 2);
    EXPECT_EQ(shot({scene_, "-o", path("shot.png"), "--size", "64"}).status, 2);
    expectNoPicture();
}

TEST_F(ShotCommand, SaysWhatIsMissingWithoutAnOpenGlDriver) {
    const Environment none("__EGL_VENDOR_LIBRARY_FILENAMES", "/nonexistent/vendor.json");
    const ProcessResult run = shoot({});
    EXPECT_EQ(run.status, 1);
    EXPECT_TRUE(contains(run.err, "'relume bake' needs none")) << run.err;
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    expectNoPicture();
}

TEST_F(ShotCommand, SaysWhatIsMissingWithAnOldOpenGl) {
    const char* mesa = "/usr/share/glvnd/egl_vendor.d/50_mesa.json";
    if (!std::filesystem::exists(mesa))
        GTEST_SKIP() << "only Mesa can pretend to be older: " << mesa << " is missing";
    const Environment vendor("__EGL_VENDOR_LIBRARY_FILENAMES", mesa), old("MESA_GL_VERSION_OVERRIDE", "4.3");
    const ProcessResult run = shoot({});
    EXPECT_EQ(run.status, 1);
    EXPECT_TRUE(contains(run.err, "OpenGL 4.3: pictures need OpenGL 4.5")) << run.err;
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    expectNoPicture();
}

TEST(ShotTurntable, IsASeriesOfPicturesThatBeginsWithTheShot) {
    const TemporaryFolder folder;
    const std::string scene = std::string(RELUME_SOURCE_DIR) + "/assets/scenes/cornell_small.glb";
    const Strings look = {scene, "--size", "64x48", "--lightmap-size", "32", "--samples", "8"};
    const auto with = [&](Strings more) {
        more.insert(more.begin(), look.begin(), look.end());
        return shot(more);
    };
    ProcessResult run = with({"-o", folder.path("turn"), "--turntable", "3", "--no-caption"});
    ASSERT_EQ(run.status, 0) << run.err;
    run = with({"-o", folder.path("one.png")});
    ASSERT_EQ(run.status, 0) << run.err;
    const FloatImage one = readImage(folder.path("one.png"));
    EXPECT_EQ(readImage(folder.path("turn/frame_0001.png")).planes, one.planes);
    for (const char* other : {"turn/frame_0002.png", "turn/frame_0003.png"})
        EXPECT_NE(readImage(folder.path(other)).planes, one.planes);
    EXPECT_FALSE(std::filesystem::exists(folder.path("turn/frame_0004.png")));
    run = with({"-o", folder.path("turn"), "--turntable", "2"});
    EXPECT_EQ(run.status, 1) << "frames are there";
    run = with({"-o", folder.path("turn"), "--turntable", "2", "--overwrite"});
    EXPECT_EQ(run.status, 0) << run.err;
    const FloatImage captioned = readImage(folder.path("turn/frame_0001.png"));
    EXPECT_NE(captioned.planes, one.planes) << "it has a caption";
    for (size_t channel = 0; channel < captioned.planes.size(); ++channel)
        for (size_t i = 0; i < size_t{captioned.width} * 4; ++i)
            ASSERT_EQ(captioned.planes[channel][i], one.planes[channel][i]) << "its upper rows are the same";
    EXPECT_FALSE(std::filesystem::exists(folder.path("turn/frame_0003.png")));
    for (const Strings& wrong :
         std::vector<Strings>{{"-o", folder.path("a.png"), "--turntable", "3"},
                              {"-o", folder.path("a.png"), "--fps", "3"},
                              {"-o", folder.path("a.png"), "--no-caption"},
                              {"-o", folder.path("t"), "--path", "nowhere"},
                              {"-o", folder.path("t"), "--seconds", "3"},
                              {"-o", folder.path("t"), "--path", "bookmarks", "--turntable", "3"},
                              {"-o", folder.path("turn")},
                              {"-o", folder.path("t"), "--turntable", "1"}})
        EXPECT_EQ(with(wrong).status, 2) << wrong[1];
}

TEST(ShotTurntable, SaysHowManyFramesThereAreWhenItIsStopped) {
    const TemporaryFolder folder;
    const std::string out = folder.path("turn");
    const std::string stopsAtThree =
        "\"$@\" & until [ -e \"$0/frame_0003.png\" ]; do sleep 0.02; done; kill $!; wait $!";
    const std::string scene = std::string(RELUME_SOURCE_DIR) + "/assets/scenes/cornell_small.glb";
    const ProcessResult run = runProgram("/bin/sh",
                                         {"-c", stopsAtThree, out, RELUME_BINARY, "shot", scene, "--view",
                                          "albedo", "--size", "64x48", "--turntable", "100000", "-o", out},
                                         nullptr, 120);
    EXPECT_EQ(run.status, 1);
    const auto frames = std::distance(std::filesystem::directory_iterator(out), {});
    EXPECT_TRUE(contains(run.err, "interrupted: " + std::to_string(frames) + " frames were written"))
        << run.err;
}

TEST(ShotPath, GoesThroughBookmarksAndCameras) {
    const TemporaryFolder folder;
    const std::string config = folder.path("config");
    const Environment home("XDG_CONFIG_HOME", config.c_str());
    const std::string scene = folder.path("room.glb");
    std::filesystem::copy_file(std::string(RELUME_SOURCE_DIR) + "/assets/scenes/cornell_small.glb", scene);
    const Strings look = {scene, "--size",    "64x48", "--lightmap-size",
                          "32",  "--samples", "8",     "--no-caption"};
    const auto with = [&](Strings more) {
        more.insert(more.begin(), look.begin(), look.end());
        return shot(more);
    };
    ProcessResult run = with({"-o", folder.path("way"), "--path", "bookmarks"});
    EXPECT_EQ(run.status, 1);
    EXPECT_TRUE(contains(run.err, "has no bookmarks, and a path needs two")) << run.err;
    EXPECT_FALSE(std::filesystem::exists(folder.path("way")));

    Preferences preferences;
    ViewCamera camera;
    camera.eye = {0.0f, 1.0f, 2.5f};
    camera.target = {0.0f, 1.0f, 0.0f};
    preferences.addBookmark(scene, camera);
    camera.eye.x = 0.5f;
    preferences.addBookmark(scene, camera);
    writePreferences(preferencesPath(), preferences);
    run = with({"-o", folder.path("way"), "--path", "bookmarks", "--seconds", "1", "--fps", "4"});
    ASSERT_EQ(run.status, 0) << run.err;
    run = shot({scene, "--size", "64x48", "--lightmap-size", "32", "--samples", "8", "-o",
                folder.path("first.png"), "--eye", "0,1,2.5", "--target", "0,1,0"});
    ASSERT_EQ(run.status, 0) << run.err;
    const auto frame = [&](int number) {
        return readImage(folder.path("way/frame_000" + std::to_string(number) + ".png")).planes;
    };
    EXPECT_EQ(frame(1), readImage(folder.path("first.png")).planes);
    for (int i = 2; i <= 5; ++i)
        EXPECT_NE(frame(i), frame(i - 1)) << i;
    EXPECT_FALSE(std::filesystem::exists(folder.path("way/frame_0006.png")));

    run = with({"-o", folder.path("none"), "--path", "animation"});
    EXPECT_EQ(run.status, 1);
    EXPECT_TRUE(contains(run.err, "has no animation: leave out --path animation")) << run.err;
}

} // namespace
} // namespace relume
