// A bake that mpirun shares among processes: the bytes are those of one process, whatever their number; an
// error, Ctrl-C and the death of one end all of them; a bake goes on with another number of processes.
#include "assets/base/clock.h"
#include "bake/ranks/mpi_ranks.h"
#include "tests/gpu/gpu_environment.h"
#include "tests/gpu/relume_process.h"
#include "tests/temporary_folder.h"
#include "tests/text.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <optional>

namespace relume {
namespace {

using RankWords = std::vector<std::string>;

// Rows of super-blocks and runs of chunks are dealt evenly to some of them and not to others.
const std::vector<uint32_t> kAnyNumber = {1, 2, 3, 5};
// mpirun gives its processes two seconds after Ctrl-C; a loaded machine takes longer.
constexpr double kAllHaveEnded = 10.0; // [s]

std::optional<std::string> findMpirun() {
    const std::string path = std::getenv("PATH") ? std::getenv("PATH") : "";
    for (size_t begin = 0; begin < path.size();) {
        const size_t end = std::min(path.find(':', begin), path.size());
        const std::string program = path.substr(begin, end - begin) + "/mpirun";
        if (std::filesystem::exists(program)) return program;
        begin = end + 1;
    }
    return {};
}

class RankBake : public testing::Test {
protected:
    void SetUp() override {
        if (!hasMpi()) GTEST_SKIP() << "the program was built without MPI";
        mpirun_ = findMpirun();
        if (!mpirun_) GTEST_SKIP() << "there is no mpirun: openmpi-bin has it";
        setenv("OMPI_ALLOW_RUN_AS_ROOT", "1", 1);
        setenv("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1", 1);
    }

    ProcessResult mpirun(uint32_t count, const RankWords& arguments,
                         const std::function<int(const std::string&)>& onErr = nullptr) const {
        RankWords words = {"--oversubscribe", "-np", std::to_string(count), RELUME_BINARY};
        words.insert(words.end(), arguments.begin(), arguments.end());
        return runProgram(*mpirun_, words, onErr);
    }

    RankWords bake(const std::string& to, const RankWords& options) const {
        RankWords words = {"bake", RELUME_SOURCE_DIR "/assets/scenes/" + scene_, "-o", folder_.path(to)};
        words.insert(words.end(), options.begin(), options.end());
        return words;
    }

    /// Bakes with each of these numbers of processes and, at first, without a launcher.
    static size_t timesIn(const std::string& text, const std::string& part) {
        size_t times = 0;
        for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
            ++times;
        return times;
    }

    void expectSameBytes(const RankWords& options, const std::vector<uint32_t>& counts) const {
        const ProcessResult plain = runRelume(bake("plain.exr", options));
        ASSERT_EQ(plain.status, 0) << plain.err;
        const std::string bytes = bytesOf(folder_.path("plain.exr"));
        ASSERT_FALSE(bytes.empty());
        for (const uint32_t count : counts) {
            const ProcessResult shared = mpirun(count, bake("shared.exr", options));
            ASSERT_EQ(shared.status, 0) << shared.err;
            EXPECT_EQ(timesIn(shared.err, "checkpoint"), 0u) << "none is asked for\n" << shared.err;
            EXPECT_TRUE(bytes == bytesOf(folder_.path("shared.exr"))) << count << " processes";
            std::filesystem::remove(folder_.path("shared.exr"));
        }
    }

    const TemporaryFolder folder_;
    std::string scene_ = "cornell_statue.glb";
    std::optional<std::string> mpirun_;
};

TEST_F(RankBake, HybridHasTheBytesOfOneProcess) {
    expectSameBytes({"--size", "64", "--error", "0.03"}, kAnyNumber);
    expectSameBytes({"--size", "64", "--samples", "48"}, {2, 4});
}

TEST_F(RankBake, ManyLightsHaveTheBytesOfOneProcess) {
    scene_ = "gallery.glb";
    expectSameBytes({"--size", "64", "--error", "0.05"}, {2, 3});
}

TEST_F(RankBake, AShareOfATownHasTheBytesOfOneProcess) {
    scene_ = "town.glb";
    expectSameBytes({"--size", "128", "--samples", "16"}, {3});
}

TEST_F(RankBake, DirectionalHasTheBytesOfOneProcess) {
    expectSameBytes({"--size", "64", "--method", "directional", "--samples", "64"}, kAnyNumber);
}

TEST_F(RankBake, MethodsOfPairsHaveTheBytesOfOneProcess) {
    expectSameBytes({"--size", "72", "--method", "pure", "--passes", "3"}, kAnyNumber);
    expectSameBytes({"--size", "64", "--method", "pure", "--preset", "rtrad", "--passes", "2"}, {3});
    // How many processes share the pairs is one rule for all methods, so a few numbers do for these.
    expectSameBytes({"--size", "72", "--method", "adaptive", "--passes", "3"}, {2, 5});
    for (const char* method : {"static", "montecarlo", "mipmapped"})
        expectSameBytes({"--size", "72", "--method", method, "--window", "4", "--passes", "2"}, {2, 5});
    expectSameBytes({"--size", "24", "--method", "pure", "--passes", "2"}, {3}); // fewer rows than processes
    scene_ = "gallery.glb"; // caches have no room for all
    expectSameBytes({"--size", "64", "--method", "pure", "--passes", "2", "--cache-memory", "2M"}, {3});
    expectSameBytes({"--size", "64", "--method", "pure", "--error", "0.05", "--device-gather"}, {2});
    scene_ = "town.glb"; // has analytic lights
    expectSameBytes({"--size", "128", "--method", "static", "--window", "16", "--passes", "1"}, {3});
}

TEST_F(RankBake, FootprintsPassesAndOtherDirectionsHaveTheBytesOfOneProcess) {
    expectSameBytes({"--size", "48", "--samples", "32", "--footprint"}, {3});
    expectSameBytes({"--size", "48", "--samples", "32", "--directions", "lec", "--no-smooth"}, {2});
    expectSameBytes({"--size", "48", "--samples", "32", "--passes", "3"}, {2});
    expectSameBytes({"--size", "48", "--samples", "32", "--cache", "none"}, {3});
}

// Each process has buffers in the host's memory, as with the least memory of the device that does.
TEST_F(RankBake, WhatTheDeviceHasNoRoomForHasTheBytesOfOneProcess) {
    scene_ = "gallery.glb";
    // The search for what lies inside something takes more of a GPU than the solver of a small map.
    const char* const size = testDevice().info().software() ? "384" : "1536";
    RankWords options = {"--size", size, "--samples",       "16", "--local-error", "0",
                         "--json", "-",  "--device-memory", "8M"};
    const ProcessResult refused = runRelume(bake("plain.exr", options));
    const size_t needs = refused.err.find(" needs ");
    ASSERT_NE(needs, std::string::npos) << refused.err;
    constexpr uint32_t kMore = 25; // [%], as a tenth of what there is is kept free, and more is asked for
    const auto least = static_cast<uint32_t>(std::stoul(refused.err.substr(needs + std::strlen(" needs "))));
    ProcessResult plain;
    for (uint32_t more = 0; more < kMore; ++more) {
        options.back() = std::to_string(least + least * more / 100) + "M";
        plain = runRelume(bake("plain.exr", options));
        if (plain.status == 0) break;
    }
    ASSERT_EQ(plain.status, 0) << plain.err;
    EXPECT_NE(plain.err.find("are read from this machine's memory"), std::string::npos) << plain.err;
    const ProcessResult shared = mpirun(3, bake("shared.exr", options));
    ASSERT_EQ(shared.status, 0) << shared.err;
    const std::string bytes = bytesOf(folder_.path("plain.exr"));
    EXPECT_TRUE(bytes == bytesOf(folder_.path("shared.exr")));
    options.resize(options.size() - 2);
    ASSERT_EQ(runRelume(bake("all.exr", options)).status, 0);
    EXPECT_TRUE(bytes == bytesOf(folder_.path("all.exr"))) << "and those of a bake with all the memory";
}

// What the shaders gather, as on a GPU, is packed.
TEST_F(RankBake, WhatADeviceGathersHasTheBytesOfOneProcess) {
    expectSameBytes({"--size", "48", "--samples", "32", "--tracer", "bvh", "--device-gather"}, {3});
}

TEST_F(RankBake, SamplesThatChunksTakeAloneHaveTheBytesOfOneProcess) {
    scene_ = "gallery.glb";
    expectSameBytes({"--size", "64", "--per-chunk", "--error", "0.05", "--local-error", "0.3"}, {2, 3});
}

TEST_F(RankBake, LayersHaveTheBytesOfOneProcess) {
    scene_ = "gallery.glb"; // it has 14 lights
    expectSameBytes({"--size", "32", "--layers", "--samples", "16"}, kAnyNumber);
    expectSameBytes({"--size", "32", "--layers", "--samples", "128", "--layer-error", "0.2", "--half"}, {2});
    scene_ = "cornell_statue.glb"; // it has one, so two of three processes have none
    expectSameBytes({"--size", "32", "--layers", "--samples", "16"}, {3});
}

TEST_F(RankBake, MoreProcessesThanChunksHaveTheBytesOfOneProcess) {
    expectSameBytes({"--size", "8", "--samples", "16"}, {3});
}

TEST_F(RankBake, TheScriptOfTheExamplesHasTheBytesOfOneProcess) {
    const ProcessResult plain = runRelume(bake("plain.exr", {"--size", "48", "--samples", "16"}));
    ASSERT_EQ(plain.status, 0) << plain.err;
    for (const auto& [name, value] : {std::pair("RELUME", RELUME_BINARY), std::pair("PROCESSES", "3"),
                                      std::pair("OMPI_MCA_rmaps_base_oversubscribe", "1")})
        setenv(name, value, 1);
    const ProcessResult shared = runProgram(RELUME_SOURCE_DIR "/assets/jobs/share_bake.sh",
                                            {RELUME_SOURCE_DIR "/assets/scenes/" + scene_,
                                             folder_.path("shared.exr"), "--size", "48", "--samples", "16"});
    unsetenv("OMPI_MCA_rmaps_base_oversubscribe");
    ASSERT_EQ(shared.status, 0) << shared.err;
    EXPECT_TRUE(bytesOf(folder_.path("plain.exr")) == bytesOf(folder_.path("shared.exr")));
}

TEST_F(RankBake, OneProcessSpeaksAndWrites) {
    const ProcessResult result = mpirun(3, bake("map.exr", {"--size", "32", "--samples", "16"}));
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(timesIn(result.err, "wrote "), 1u) << result.err;
    EXPECT_EQ(timesIn(result.err, "tracer: "), 1u) << result.err;
}

/// Processes that fail: mpirun does not wait for a second before it kills those that have ended anyway.
class RankError : public RankBake {
protected:
    RankError() { setenv(kPatience, "0", 1); }
    ~RankError() override { unsetenv(kPatience); }

private:
    static constexpr const char* kPatience = "OMPI_MCA_odls_base_sigkill_timeout";
};

TEST_F(RankError, IsToldOnce) {
    const ProcessResult missing = mpirun(3, {"bake", "missing.glb", "-o", folder_.path("map.exr")});
    EXPECT_EQ(missing.status, 1) << missing.err;
    EXPECT_EQ(timesIn(missing.err, "error: "), 1u) << missing.err;
    const ProcessResult wrong = mpirun(3, bake("map.exr", {"--size", "x"}));
    EXPECT_EQ(wrong.status, 2) << wrong.err;
    EXPECT_EQ(timesIn(wrong.err, "error: "), 1u) << wrong.err;
}

// Only the first process writes, so only it finds this out.
TEST_F(RankError, OfOneProcessEndsAll) {
    const std::string file = folder_.path("no folder/map.exr");
    const ProcessResult result = mpirun(3, {"bake", RELUME_SOURCE_DIR "/assets/scenes/" + scene_, "-o", file,
                                            "--size", "32", "--samples", "16"});
    EXPECT_EQ(result.status, 1) << result.err;
    EXPECT_EQ(timesIn(result.err, "error: "), 1u) << result.err;
    EXPECT_TRUE(contains(result.err, "no folder")) << result.err;
}

TEST_F(RankError, IsToldOnceWhereProcessesCannotShare) {
    for (const RankWords& options : {RankWords{"--layers"}, RankWords{"--indirect-scale", "2"}}) {
        const ProcessResult result = mpirun(2, bake("map.exr", options));
        EXPECT_EQ(result.status, 2) << result.err;
        EXPECT_EQ(timesIn(result.err, "error: "), 1u) << result.err;
        EXPECT_TRUE(contains(result.err, options.front())) << result.err;
        EXPECT_FALSE(std::filesystem::exists(folder_.path("map.exr")));
    }
    const ProcessResult info = mpirun(2, {"info", RELUME_SOURCE_DIR "/assets/scenes/" + scene_});
    EXPECT_EQ(info.status, 2) << info.err;
    EXPECT_EQ(timesIn(info.err, "error: relume info: "), 1u) << info.err;
    EXPECT_TRUE(info.out.empty()) << info.out;
}

class RankCheckpoint : public RankBake {
protected:
    RankWords how_ = {"--size", "64", "--samples", "512"};

    RankWords options(const RankWords& more) const {
        RankWords words = how_;
        words.insert(words.end(), more.begin(), more.end());
        return words;
    }
    std::string file() const { return folder_.path("bake.checkpoint"); }

    void expectGoesOn(const std::vector<uint32_t>& counts) const {
        ASSERT_TRUE(std::filesystem::exists(file()));
        const ProcessResult plain = runRelume(bake("plain.exr", options({})));
        ASSERT_EQ(plain.status, 0) << plain.err;
        for (const uint32_t count : counts) {
            const ProcessResult second = mpirun(count, bake("second.exr", options({"--resume", file()})));
            ASSERT_EQ(second.status, 0) << second.err;
            EXPECT_EQ(timesIn(second.err, "resumed after "), 1u) << second.err;
            EXPECT_TRUE(bytesOf(folder_.path("plain.exr")) == bytesOf(folder_.path("second.exr"))) << count;
        }
    }
};

} // namespace

// mpirun passes this signal on to all, and waits for them.
TEST_F(RankCheckpoint, ASignalLeavesOneThatAnotherNumberOfProcessesGoesOnFrom) {
    bool sent = false;
    const ProcessResult first =
        mpirun(4, bake("first.exr", options({"--checkpoint", file()})), [&](const std::string& err) {
            if (sent || !contains(err, " patches\n")) return 0;
            sent = true;
            return SIGUSR1;
        });
    EXPECT_EQ(first.status, 1) << first.err;
    EXPECT_EQ(timesIn(first.err, "error: "), 1u) << first.err;
    EXPECT_TRUE(contains(first.err, "error: interrupted: go on with --resume " + file() + "\n")) << first.err;
    EXPECT_EQ(folder_.files(), (RankWords{"bake.checkpoint"}));
    expectGoesOn({3, 1});
}

TEST_F(RankBake, CtrlCEndsAllAndNothingIsWritten) {
    std::optional<Clock::time_point> sent;
    const ProcessResult result =
        mpirun(3, bake("map.exr", {"--size", "1024", "--samples", "4096"}), [&](const std::string& err) {
            if (sent || !contains(err, " patches\n")) return 0;
            sent = Clock::now();
            return SIGINT;
        });
    ASSERT_TRUE(sent);
    EXPECT_NE(result.status, 0) << result.err;
    EXPECT_LT(secondsSince(*sent), kAllHaveEnded);
    EXPECT_TRUE(folder_.files().empty());
}

TEST_F(RankCheckpoint, TheDeathOfAProcessEndsAllAndTheBakeGoesOn) {
    // The second process is killed as soon as there is a checkpoint.
    const TemporaryFolder beside;
    const std::string killed = beside.path("killed");
    std::string script = "if [ \"$OMPI_COMM_WORLD_RANK\" != 1 ]; then exec \"$@\"; fi; \"$@\" & pid=$!; "
                         "until [ -e '" +
                         file() + "' ]; do sleep 0.02; done; kill -9 $pid; : > '" + killed + "'; wait $pid";
    RankWords words = {"--oversubscribe", "-np", "3", "sh", "-c", script, "sh", RELUME_BINARY};
    const RankWords arguments =
        bake("first.exr", options({"--checkpoint", file(), "--checkpoint-every", "0.05"}));
    words.insert(words.end(), arguments.begin(), arguments.end());
    const ProcessResult first = runProgram(*mpirun_, words);
    EXPECT_NE(first.status, 0) << first.err;
    ASSERT_TRUE(std::filesystem::exists(killed)) << first.err;
    const std::chrono::duration<double> lived =
        std::filesystem::file_time_type::clock::now() - std::filesystem::last_write_time(killed);
    EXPECT_LT(lived.count(), kAllHaveEnded);
    EXPECT_LE(timesIn(first.err, "error: "), 1u) << first.err;
    EXPECT_FALSE(std::filesystem::exists(folder_.path("first.exr"))) << "it had been done before";
    expectGoesOn({2, 3});
}

// A process alone stops within a pass, of which each of several then does its own share.
TEST_F(RankCheckpoint, OfOneProcessIsTakenUpBySeveral) {
    bool sent = false;
    const ProcessResult first = runRelume(
        bake("first.exr", options({"--checkpoint", file(), "--batch-ms", "1"})), [&](const std::string& err) {
            if (sent || !contains(err, " patches\n")) return 0;
            sent = true;
            return SIGINT;
        });
    EXPECT_EQ(first.status, 1) << first.err;
    expectGoesOn({3});
}

// A checkpoint of one process, within a pass, holds what all rows have so far; one of four is made between
// passes.
TEST_F(RankCheckpoint, OfPairsIsTakenUpBySeveralAndByFewer) {
    how_ = {"--size", "96", "--method", "pure", "--passes", "2", "--cache", "none"};
    for (const uint32_t count : {1u, 4u}) {
        bool sent = false;
        const auto stop = [&](const std::string& err) {
            if (sent || !contains(err, " patches\n")) return 0;
            sent = true;
            return count == 1 ? SIGINT : SIGUSR1;
        };
        const RankWords words = bake("first.exr", options({"--checkpoint", file(), "--batch-ms", "1"}));
        const ProcessResult first = count == 1 ? runRelume(words, stop) : mpirun(count, words, stop);
        EXPECT_EQ(first.status, 1) << first.err;
        ASSERT_TRUE(contains(first.err, "go on with --resume")) << count << " processes\n" << first.err;
        expectGoesOn({3});
        std::filesystem::remove(file());
    }
}

} // namespace relume
