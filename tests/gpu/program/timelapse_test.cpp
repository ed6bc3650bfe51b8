// This runs `relume timelapse` as a user does: it checks which frames there are, what they show, and what is
// refused.
#include "assets/gltf/gltf.h"
#include "assets/images/float_image.h"
#include "assets/images/image_file.h"
#include "tests/gpu/bake_scene.h"
#include "tests/gpu/gpu_environment.h"
#include "tests/gpu/relume_process.h"
#include "tests/temporary_folder.h"
#include "tests/text.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace relume {
namespace {

namespace fs = std::filesystem;
using Strings = std::vector<std::string>;

Strings joined(Strings first, const Strings& second) {
    first.insert(first.end(), second.begin(), second.end());
    return first;
}

/// Sets PATH while it lives.
class Path {
public:
    explicit Path(const std::string& value) : old_(std::getenv("PATH")) { setenv("PATH", value.c_str(), 1); }
    ~Path() { setenv("PATH", old_.c_str(), 1); }
    Path(const Path&) = delete;
    Path& operator=(const Path&) = delete;

private:
    std::string old_;
};

class TimelapseCommand : public testing::Test {
protected:
    TimelapseCommand() {
        SceneMaker maker(64);
        // A mesh light is in the ceiling of a room: from bounce to bounce more of the room is lit.
        std::array<int, 6> materials;
        materials.fill(maker.material(0.7f));
        materials[4] = maker.material(0.0f, 2.0f);
        std::array<glm::uvec2, 6> texels;
        texels.fill(glm::uvec2(14));
        maker.box({0, 0, 0}, {glm::vec3(2, 0, 0), {0, 2, 0}, {0, 0, 2}}, materials, texels);
        saveGlb(maker.scene(), scene_);
    }
    std::string path(const std::string& name) const { return folder_.path(name); }
    static Strings look() { return {"--size", "320x180", "--lightmap-size", "64"}; }
    ProcessResult run(const Strings& more) const {
        Strings arguments = joined({"-q", "timelapse", scene_}, joined(look(), more));
        if (const char* device = std::getenv("RELUME_TEST_DEVICE"))
            arguments.insert(arguments.end(), {"--device", device});
        return runRelume(arguments);
    }
    Strings framesIn(const std::string& name) const {
        Strings names;
        for (const auto& entry : fs::directory_iterator(path(name)))
            names.push_back(entry.path().filename());
        std::sort(names.begin(), names.end());
        return names;
    }
    void expectError(int status, const std::string& text, const Strings& more) const {
        const ProcessResult r = run(more);
        EXPECT_EQ(r.status, status) << r.err;
        EXPECT_TRUE(contains(r.err, text)) << r.err;
        EXPECT_EQ(std::count(r.err.begin(), r.err.end(), '\n'), 1) << r.err;
    }

    /// Puts a shell script in ffmpeg's place.
    Path withFfmpeg(const std::string& script) const {
        std::ofstream(path("ffmpeg")) << "#!/bin/sh\n" << script << "\n";
        fs::permissions(path("ffmpeg"), fs::perms::owner_all);
        return Path(path("") + ":" + std::getenv("PATH"));
    }

    TemporaryFolder folder_;
    const std::string video_ = folder_.path("out.mp4");
    const std::string scene_ = folder_.path("room.glb");
    const Strings pure_ = {"--method", "pure", "--passes", "5"};
};

const Strings kThree = {"frame_0001.png", "frame_0002.png", "frame_0003.png"};
const Strings kFour = {"frame_0001.png", "frame_0002.png", "frame_0003.png", "frame_0004.png"};

} // namespace

TEST_F(TimelapseCommand, ShowsTheBakeAsItConverges) {
    const ProcessResult r = run(joined({"-o", path("out"), "--no-caption"}, pure_));
    ASSERT_EQ(r.status, 0) << r.err;
    EXPECT_EQ(r.out, "");
    ASSERT_EQ(framesIn("out"), kFour); // after 1, 2, 4 and 5 passes
    // There is one exposure for all, and every bounce makes it brighter.
    double before = 0;
    for (const std::string& name : kFour) {
        const FloatImage image = readImage(path("out/" + name));
        EXPECT_EQ(image.width, 320u);
        EXPECT_EQ(image.height, 180u);
        double sum = 0;
        for (const float value : image.planes[1])
            sum += value;
        EXPECT_GT(sum, 1.001 * before) << name;
        before = sum;
    }
    const Strings shot = joined({"-q", "shot", scene_, "-o", path("shot.png")}, joined(look(), pure_));
    ASSERT_EQ(runRelume(shot).status, 0);
    EXPECT_EQ(bytesOf(path("shot.png")), bytesOf(path("out/frame_0004.png")));
}

// Frames on the way, which smooth the light, must not change its end.
TEST_F(TimelapseCommand, EndsAsTheShotOfTheSameBakeWhateverTheMethod) {
    const Strings hybrid = {"--samples", "64", "--exposure", "1"};
    const ProcessResult r = run(joined({"-o", path("out"), "--no-caption"}, hybrid));
    ASSERT_EQ(r.status, 0) << r.err;
    const Strings frames = framesIn("out");
    ASSERT_GE(frames.size(), 1u);
    const Strings shot = joined({"-q", "shot", scene_, "-o", path("shot.png")}, joined(look(), hybrid));
    ASSERT_EQ(runRelume(shot).status, 0);
    EXPECT_EQ(bytesOf(path("shot.png")), bytesOf(path("out/" + frames.back())));
}

TEST_F(TimelapseCommand, TakesTheFramesAskedForAndTheLastOne) {
    ASSERT_EQ(run(joined({"-o", path("out/"), "--at", "1,3,200"}, pure_)).status, 0);
    EXPECT_EQ(framesIn("out"), kThree); // after 1, 3 and 5 passes
}

TEST_F(TimelapseCommand, CaptionsLeaveTheRestOfThePictureAlone) {
    ASSERT_EQ(run(joined({"-o", path("with"), "--at", "1"}, pure_)).status, 0);
    ASSERT_EQ(run(joined({"-o", path("without"), "--at", "1", "--no-caption"}, pure_)).status, 0);
    const FloatImage with = readImage(path("with/frame_0001.png"));
    const FloatImage without = readImage(path("without/frame_0001.png"));
    uint32_t changed = 0;
    for (uint32_t y = 0; y < 180; ++y) {
        for (uint32_t x = 0; x < 320; ++x) {
            const size_t i = size_t{320} * y + x;
            const bool differs = with.planes[0][i] != without.planes[0][i];
            changed += differs ? 1 : 0;
            if (differs) {
                ASSERT_GE(y, 140u);
                ASSERT_LT(x, 240u);
            }
        }
    }
    EXPECT_GT(changed, 1000u);
}

TEST_F(TimelapseCommand, CountsTimeWhereItIsAskedTo) {
    // A fast GPU makes five passes within one frame's time.
    const Strings longer = {"--method", "pure", "--passes", "20"};
    ASSERT_EQ(run(joined({"-o", path("out"), "--fps", "100", "--batch-ms", "1"}, longer)).status, 0);
    const Strings frames = framesIn("out");
    EXPECT_GE(frames.size(), 2u);
    EXPECT_NE(bytesOf(path("out/" + frames.front())), bytesOf(path("out/" + frames.back())));
}

TEST_F(TimelapseCommand, KeepsTheFramesOfAnotherRunUnlessToldOtherwise) {
    ASSERT_EQ(run(joined({"-o", path("out")}, pure_)).status, 0);
    std::ofstream(path("out/mine.png")) << "mine";
    const std::string before = bytesOf(path("out/frame_0001.png"));
    expectError(1, "out: holds frames (frame_0001.png): name another folder, or pass --overwrite",
                joined({"-o", path("out"), "--at", "2"}, pure_));
    EXPECT_EQ(bytesOf(path("out/frame_0001.png")), before);
    ASSERT_EQ(run(joined({"-o", path("out"), "--at", "2", "--overwrite"}, pure_)).status, 0);
    EXPECT_EQ(framesIn("out"), (Strings{"frame_0001.png", "frame_0002.png", "mine.png"}));
}

TEST_F(TimelapseCommand, LeavesWholeFramesBehindWhenItIsStopped) {
    // This is far more than is waited for.
    const Strings arguments = {
        "timelapse",       scene_, "-o",       path("out"),   "--exposure", "0",     "--size",     "320x180",
        "--lightmap-size", "256",  "--method", "directional", "--samples",  "65536", "--batch-ms", "1"};
    bool stopped = false; // a second signal would end it at once
    const ProcessResult r = runRelume(arguments, [&](const std::string&) {
        if (stopped || !fs::exists(path("out/frame_0003.png"))) return 0;
        stopped = true;
        return SIGINT;
    });
    if (r.status == 0 && !testDevice().info().software()) GTEST_SKIP() << "faster than it can be stopped";
    EXPECT_EQ(r.status, 1);
    EXPECT_TRUE(contains(r.err, "frames were written")) << r.err;
    for (const std::string& name : framesIn("out"))
        EXPECT_EQ(readImage(path("out/" + name)).width, 320u) << name;
}

TEST_F(TimelapseCommand, RefusesWrongUsage) {
    const std::vector<Strings> wrong = {{"--at", "0"},
                                        {"--at", "1,,2"},
                                        {"--at", "4,2"},
                                        {"--at", "one"},
                                        {"--at", "1,2", "--fps", "5"},
                                        {"--fps", "0"},
                                        {"--view", "albedo"},
                                        {"--lightmap", "room.exr"},
                                        {"--exposure", "bright"}};
    for (const Strings& arguments : wrong) {
        const ProcessResult r = run(joined({"-o", path("out")}, arguments));
        EXPECT_EQ(r.status, 2) << arguments[0] << ": " << r.err;
    }
    EXPECT_EQ(run({"-o", path("out.avi")}).status, 2);
    EXPECT_EQ(run({"-o", path("out.mp4"), "--overwrite"}).status, 2);
    EXPECT_EQ(run({"-o", path("out.mp4"), "--size", "321x180"}).status, 2);
    expectError(1, "room.glb: is a file", {"-o", scene_});
    expectError(1, "nosuchfolder", {"-o", path("nosuchfolder/out")});
    EXPECT_EQ(folder_.files(), Strings{"room.glb"});
}

TEST_F(TimelapseCommand, SaysHowToGetFfmpegWhereThereIsNone) {
    const Path none("/nonexistent");
    expectError(1, "out.mp4: a video needs ffmpeg, which is not installed: run 'apt-get install ffmpeg'",
                joined({"-o", path("out.mp4")}, pure_));
    EXPECT_EQ(folder_.files(), Strings{"room.glb"});
}

// In place of the real ffmpeg, this reads a little, complains and goes, while more frames come.
TEST_F(TimelapseCommand, TellsWhatFfmpegSaidLastAndLeavesNothing) {
    const Path path = withFfmpeg("head -c 1000 >/dev/null; echo first >&2; echo no such encoder >&2; exit 1");
    expectError(1, "out.mp4: ffmpeg failed: no such encoder", joined({"-o", video_}, pure_));
    EXPECT_EQ(folder_.files(), (Strings{"ffmpeg", "room.glb"}));
}

// In place of the real ffmpeg, this writes down its arguments and how many bytes it was given.
TEST_F(TimelapseCommand, GivesFfmpegTheFramesAndHoldsTheLastForTwoSeconds) {
    const Path path = withFfmpeg("for last; do :; done; { echo \"$@\"; wc -c; } > \"${last#file:}\"");
    const ProcessResult r = run(joined({"-o", video_}, pure_));
    ASSERT_EQ(r.status, 0) << r.err;
    const std::string told = bytesOf(video_);
    EXPECT_TRUE(contains(told, "-s 320x180 -r 2 ")) << told;
    // There are four frames, and the last one lasts for two seconds at two frames per second.
    EXPECT_TRUE(contains(told, fmt::format("\n{}\n", 3 * 320 * 180 * (3 + 4)))) << told;
    EXPECT_EQ(folder_.files(), (Strings{"ffmpeg", "out.mp4", "room.glb"}));
}

TEST_F(TimelapseCommand, MakesAVideo) {
    if (std::system("ffmpeg -version >/dev/null 2>&1") != 0) GTEST_SKIP() << "ffmpeg is not installed";
    std::ofstream(path("out.mp4")) << "an older one";
    const ProcessResult r = run(joined({"-o", path("out.mp4"), "--fps", "4", "--at", "1,2"}, pure_));
    ASSERT_EQ(r.status, 0) << r.err;
    EXPECT_EQ(folder_.files(), (Strings{"out.mp4", "room.glb"}));
    EXPECT_EQ(bytesOf(path("out.mp4")).substr(4, 4), "ftyp");
    // There are two frames and two seconds of the last one.
    const std::string count =
        "test $(ffmpeg -v error -i '" + path("out.mp4") + "' -f framemd5 - | grep -vc '^#') = 10";
    EXPECT_EQ(std::system(count.c_str()), 0);
}

} // namespace relume
