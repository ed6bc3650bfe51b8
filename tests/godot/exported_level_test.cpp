// These tests open exported levels in Godot 4.2 or newer under Xvfb, by the code that comes with them.
#include "assets/images/image_file.h"
#include "tests/gpu/relume_process.h"
#include "tests/temporary_folder.h"
#include "tests/text.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>

namespace relume {
namespace {

namespace fs = std::filesystem;

const std::string kSource = RELUME_SOURCE_DIR;
constexpr double kLimit = 300; // [s] for a run of Godot, most of which compiles shaders
constexpr const char* kPictureSize = "640x360";

void writeText(const std::string& path, const std::string& text) {
    fs::create_directories(fs::path(path).parent_path());
    std::ofstream(path) << text;
}

// A camera as `relume shot` and show_level.gd take it.
struct Seen {
    std::string eye, target, fov;
};
const Seen kRoom{"0,1,3.5", "0,1,0", "45"};

class ExportedLevel : public testing::TestWithParam<std::string> {
protected:
    void SetUp() override {
        const ProcessResult version = runProgram("/usr/bin/env", {"godot", "--version"});
        if (version.status != 0 || !version.out.starts_with("4."))
            GTEST_SKIP() << "Godot 4 is not there: install it, and Debian's package xvfb";
        writeText(project("project.godot"), "config_version=5\n\n[application]\n\nconfig/name=\"Level\"\n");
    }
    std::string project(const std::string& name) const { return folder_.path("project/" + name); }
    /// Runs Godot on the project, with a window or without.
    ProcessResult godot(std::vector<std::string> words, bool window) const {
        std::vector<std::string> all = window ? std::vector<std::string>{"xvfb-run", "-a", "godot"}
                                              : std::vector<std::string>{"godot", "--headless"};
        all.insert(all.end(), {"--path", folder_.path("project"), "--audio-driver", "Dummy"});
        all.insert(all.end(), words.begin(), words.end());
        return runProgram("/usr/bin/env", all, nullptr, kLimit);
    }
    /// Exports a scene into the project, and has Godot import it.
    void exportScene(const std::string& scene, std::vector<std::string> words) const {
        words.insert(words.begin(), {"export", scene, "--for", "godot", "-o", project("level")});
        const ProcessResult exported = runRelume(words);
        ASSERT_EQ(exported.status, 0) << exported.err;
        const ProcessResult imported = godot({"--import"}, false);
        ASSERT_EQ(imported.status, 0) << imported.out << imported.err;
        EXPECT_FALSE(contains(imported.out + imported.err, "ERROR")) << imported.out << imported.err;
    }
    /// Returns the picture that Godot draws with its renderer `method`.
    FloatImage drawn(const std::string& method, const Seen& seen) const {
        fs::copy_file(kSource + "/tests/godot/show_level.gd", project("show_level.gd"),
                      fs::copy_options::skip_existing);
        const std::string picture = folder_.path("godot.png");
        const ProcessResult shown = godot({"--rendering-method", method, "--resolution", kPictureSize,
                                           "--script", "res://show_level.gd", "--", "res://level/level.tscn",
                                           picture, seen.eye, seen.target, seen.fov},
                                          true);
        EXPECT_EQ(shown.status, 0) << shown.out << shown.err;
        EXPECT_FALSE(contains(shown.out + shown.err, "ERROR")) << shown.out << shown.err;
        return readImage(picture);
    }
    /// Returns the picture of `relume shot` by the lightmap that was exported.
    FloatImage ours(const std::string& scene, const Seen& seen, const std::string& exposure) const {
        const std::string picture = folder_.path("relume.png");
        const ProcessResult shown =
            runRelume({"shot", scene, "--lightmap", project("level/lightmap.exr"), "--eye=" + seen.eye,
                       "--target=" + seen.target, "--fov", seen.fov, "--size", kPictureSize, "--tone", "none",
                       "--filter", "bicubic", "--exposure", exposure, "-o", picture});
        EXPECT_EQ(shown.status, 0) << shown.err;
        return readImage(picture);
    }

    TemporaryFolder folder_;
};

// Returns by how much this share of all pixels differ at most [steps of 8 bits], of linear light brought back
// to what a screen gets.
double stepsWithin(const FloatImage& a, const FloatImage& b, double share) {
    constexpr double kSteps = 255;
    std::vector<double> steps;
    for (const char* channel : {"R", "G", "B"}) {
        const std::vector<float>&left = *a.find(channel), &right = *b.find(channel);
        EXPECT_EQ(left.size(), right.size());
        for (size_t i = 0; i < std::min(left.size(), right.size()); ++i)
            steps.push_back(kSteps *
                            std::abs(srgbFromLinear(double{left[i]}) - srgbFromLinear(double{right[i]})));
    }
    const auto at = steps.begin() + static_cast<ptrdiff_t>(share * static_cast<double>(steps.size() - 1));
    std::nth_element(steps.begin(), at, steps.end());
    return *at;
}

} // namespace

// Edges are smoothed otherwise, by which some hundredths of all pixels differ.
TEST_P(ExportedLevel, IsShownAsByRelume) {
    const std::string scene = kSource + "/assets/scenes/gallery.glb";
    const Seen aisle{"-6.95,1.85,0.75", "-5.973,1.8325,0.537", "64"};
    exportScene(scene, {"--size", "256", "--samples", "64", "--exposure", "0"});
    const FloatImage theirs = drawn(GetParam(), aisle), own = ours(scene, aisle, "0");
    EXPECT_LE(stepsWithin(theirs, own, 0.5), 1.0);
    EXPECT_LE(stepsWithin(theirs, own, 0.9), 2.0);
}

// Daylight is thousands of times what a screen shows, and one renderer keeps no light above 2.
TEST_P(ExportedLevel, OfDaylightIsShownBeforeItsSky) {
    const std::string scene = folder_.path("day.glb");
    const ProcessResult edited =
        runRelume({"edit", kSource + "/assets/scenes/cornell_small.glb", "--set", "Light.strength=200000",
                   "--add", "sky,intensity=2000", "-o", scene});
    ASSERT_EQ(edited.status, 0) << edited.err;
    exportScene(scene, {"--size", "128", "--samples", "64", "--exposure", "-12"});
    const FloatImage theirs = drawn(GetParam(), kRoom), own = ours(scene, kRoom, "-12");
    EXPECT_LE(stepsWithin(theirs, own, 0.5), 1.0);
    EXPECT_LE(stepsWithin(theirs, own, 0.9), 2.0);
}

INSTANTIATE_TEST_SUITE_P(Renderers, ExportedLevel,
                         testing::Values("forward_plus", "mobile", "gl_compatibility"),
                         [](const auto& method) { return method.param; });

using SavedLevel = ExportedLevel;

// The lightmap would come along as text.
TEST_P(SavedLevel, StaysSmallAndLit) {
    exportScene(kSource + "/assets/scenes/cornell_small.glb", {"--size", "128", "--samples", "64"});
    writeText(
        project("addons/saver/plugin.cfg"),
        "[plugin]\nname=\"saver\"\ndescription=\"\"\nauthor=\"\"\nversion=\"1\"\nscript=\"saver.gd\"\n");
    fs::copy_file(kSource + "/tests/godot/save_level.gd", project("addons/saver/saver.gd"));
    writeText(project("project.godot"),
              "config_version=5\n\n[application]\n\nconfig/name=\"Level\"\n\n[editor_plugins]\n\n"
              "enabled=PackedStringArray(\"res://addons/saver/plugin.cfg\")\n");
    const ProcessResult saved = godot({"--editor"}, true);
    EXPECT_TRUE(contains(saved.out, "SAVED")) << saved.out << saved.err;
    EXPECT_TRUE(contains(saved.out, "LIT")) << saved.out << saved.err;
    EXPECT_LT(fs::file_size(project("level/level.tscn")), 4000u);
}

INSTANTIATE_TEST_SUITE_P(Editor, SavedLevel, testing::Values("forward_plus"));

} // namespace relume
