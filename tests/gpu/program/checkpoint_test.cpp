// A bake that was stopped, even killed, and goes on from its checkpoint gives the bytes of one that was not.
#include "assets/generate/generate.h"
#include "assets/gltf/gltf.h"
#include "assets/images/float_image.h"
#include "bake/links/link_solver.h"
#include "bake/output/checkpoint.h"
#include "bake/trace/make_tracer.h"
#include "tests/gpu/bake_scene.h"
#include "tests/gpu/gpu_environment.h"
#include "tests/gpu/relume_process.h"
#include "tests/temporary_folder.h"
#include "tests/text.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <random>
#include <utility>

namespace relume {
namespace {

using Strings = std::vector<std::string>;

struct ResumedCase {
    const char* name;
    BakeDesc desc;
};

class ResumedSolver : public testing::TestWithParam<ResumedCase> {};

void expectSameBytes(const std::vector<float>& a, const std::vector<float>& b, const std::string& what) {
    ASSERT_EQ(a.size(), b.size());
    EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(float)), 0) << what;
}

bool resumed(const ProcessResult& r) {
    return contains(r.err, "resumed after ");
}

} // namespace

// The bake is handed on from one solver to the next after 1, 2, 4, 8 ... steps, every other time with other
// batches and without a cache.
TEST_P(ResumedSolver, GivesTheSameBytes) {
    const TemporaryFolder folder;
    const std::string file = folder.path("checkpoint");
    const Scene scene = generateScene("cornell_geom");
    const CheckpointKey key = {"1", GetParam().name, 1};
    BakeDesc desc = GetParam().desc;
    const Baked straight = bakeScene(scene, desc);
    desc.batchMs = 0.2;
    BakeDesc other = desc;
    other.batchMs = 1.0;
    other.cache.kind = CacheSettings::Kind::None;
    std::unique_ptr<Baker> baker = makeBaker(scene, desc);
    uint32_t handed = 0;
    for (uint32_t steps = 1; !baker->solver().done(); steps *= 2) {
        for (uint32_t i = 0; i < steps && !baker->solver().done(); ++i)
            baker->solver().step();
        if (baker->solver().done()) break;
        saveCheckpoint(file, key, baker->solver());
        baker = makeBaker(scene, ++handed % 2 == 1 ? other : desc);
        Checkpoint(file, key.version).restore(key, baker->solver());
    }
    EXPECT_GE(handed, 4u); // else it was no test
    const FloatImage map = baker->lightmap({.quantity = Quantity::Lighting, .sew = false});
    for (size_t k = 0; k < map.planes.size(); ++k)
        expectSameBytes(map.planes[k], straight.lighting.planes[k], map.channels[k]);
    const SolverProgress& progress = baker->solver().progress();
    EXPECT_EQ(progress.error, straight.progress.error);
    EXPECT_EQ(progress.localError95, straight.progress.localError95);
    EXPECT_EQ(progress.localError99, straight.progress.localError99);
    EXPECT_EQ(progress.passes, straight.progress.passes);
    EXPECT_EQ(progress.samples, straight.progress.samples);
    EXPECT_EQ(progress.converged, straight.progress.converged);
    EXPECT_EQ(progress.pairs, straight.progress.pairs);
    EXPECT_EQ(progress.passSeconds.size(), straight.progress.passSeconds.size());
}

INSTANTIATE_TEST_SUITE_P(
    Methods, ResumedSolver,
    testing::Values(
        ResumedCase{"hybrid",
                    {.size = 48, .passes = 0, .error = 0.03, .method = Method::Hybrid, .smooth = true}},
        ResumedCase{"localError",
                    {.size = 48,
                     .passes = 0,
                     .error = 0.1,
                     .localError = 0.1,
                     .method = Method::Hybrid,
                     .smooth = true}},
        ResumedCase{"perChunk",
                    {.size = 48,
                     .passes = 0,
                     .error = 0.1,
                     .localError = 0.1,
                     .perChunk = true,
                     .method = Method::Hybrid,
                     .smooth = true}},
        ResumedCase{"layersLocalError",
                    {.size = 48,
                     .passes = 0,
                     .error = 0.1,
                     .localError = 0.1,
                     .method = Method::Hybrid,
                     .smooth = true,
                     .layers = true}},
        ResumedCase{"layers",
                    {.size = 48,
                     .passes = 0,
                     .method = Method::Hybrid,
                     .samples = 64,
                     .smooth = true,
                     .layers = true}},
        ResumedCase{"layersOnDevice",
                    {.size = 48,
                     .passes = 0,
                     .error = 0.05,
                     .method = Method::Hybrid,
                     .smooth = true,
                     .deviceGather = true,
                     .layers = true}},
        ResumedCase{"hybridSamples", {.size = 48, .passes = 0, .method = Method::Hybrid, .samples = 64}},
        ResumedCase{"hybridPasses", {.size = 48, .passes = 4, .method = Method::Hybrid, .samples = 192}},
        ResumedCase{"footprint",
                    {.size = 48,
                     .passes = 0,
                     .error = 0.03,
                     .method = Method::Hybrid,
                     .smooth = true,
                     .footprint = true}},
        ResumedCase{"directional", {.size = 48, .passes = 0, .error = 0.2, .method = Method::Directional}},
        ResumedCase{"pure", {.size = 48, .passes = 3, .method = Method::Pure}},
        ResumedCase{"montecarlo",
                    {.size = 64, .passes = 3, .method = Method::MonteCarlo, .pairs = {.window = 2}}},
        ResumedCase{"mipmapped",
                    {.size = 64, .passes = 3, .method = Method::Mipmapped, .pairs = {.window = 2}}},
        ResumedCase{"adaptive",
                    {.size = 64, .passes = 3, .method = Method::Adaptive, .pairs = {.threshold = 0.02}}},
        ResumedCase{"pureError", {.size = 32, .passes = 0, .error = 0.05, .method = Method::Pure}}),
    [](const auto& test) { return std::string(test.param.name); });

namespace {

class ResumedCommand : public testing::Test {
protected:
    ResumedCommand() { saveGlb(generateScene("cornell_geom"), scene_); }

    ProcessResult bake(const Strings& more, const std::function<int(const std::string& err)>& onErr = nullptr,
                       double killAfter = 0) const {
        Strings arguments = {"bake", scene_, "--size", "64"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return runRelume(arguments, onErr, killAfter);
    }
    /// Runs a bake that gets the signal as soon as it solves.
    ProcessResult interrupted(const Strings& arguments, int number) const {
        bool sent = false;
        return bake(arguments, [&](const std::string& err) {
            if (sent || !contains(err, " patches\n")) return 0;
            sent = true;
            return number;
        });
    }
    /// Kills the bake so many times, at moments drawn from the whole of its duration, and lets it go on from
    /// what is there. Whenever it came to its end it must have written the same bytes. `method` returns the
    /// arguments of a bake of so many samples or bounces; the count is raised, up to `most`, until the bake
    /// takes its time on this device, whatever it takes to start there.
    void killAndResume(const std::function<Strings(uint32_t)>& method, uint32_t count, uint32_t most,
                       uint32_t kills, uint32_t seed) const {
        using Clock = std::chrono::steady_clock;
        Strings arguments;
        std::string expected;
        double seconds = 0, atLeast = kLongEnough;
        for (bool first = true; (first || seconds < atLeast) && count <= most; count *= 4) {
            arguments = method(count);
            arguments.insert(arguments.end(), {"-o", map_});
            const auto start = Clock::now();
            ASSERT_EQ(bake(arguments).status, 0);
            seconds = std::chrono::duration<double>(Clock::now() - start).count();
            if (std::exchange(first, false) && !testDevice().info().software()) atLeast = 1.5 * seconds;
            expected = bytesOf(map_);
            std::filesystem::remove(map_);
        }
        arguments.insert(arguments.end(), {"--checkpoint", checkpoint_, "--checkpoint-every", "0.05"});

        std::mt19937 random(seed);
        std::uniform_real_distribution<double> delay(0.0, seconds);
        uint32_t killed = 0, goneOn = 0;
        while (killed < kills || std::filesystem::exists(checkpoint_)) {
            Strings now = arguments;
            if (std::filesystem::exists(checkpoint_)) now.insert(now.end(), {"--resume", checkpoint_});
            const ProcessResult r = bake(now, nullptr, killed < kills ? delay(random) : 0.0);
            goneOn += resumed(r);
            if (r.status == 128 + SIGKILL) {
                ++killed;
                continue;
            }
            ASSERT_EQ(r.status, 0) << r.err;
            ASSERT_EQ(bytesOf(map_), expected) << "after " << killed << " kills";
            std::filesystem::remove(map_);
            std::filesystem::remove(checkpoint_);
        }
        EXPECT_GE(goneOn, kills / 4);
    }

    static constexpr double kLongEnough = 0.45; // half as much again as starting takes [s]

    TemporaryFolder folder_;
    const std::string scene_ = folder_.path("box.glb"), map_ = folder_.path("map.exr"),
                      checkpoint_ = folder_.path("map.checkpoint");
};

} // namespace

TEST_F(ResumedCommand, TwentyKillsChangeNoByte) {
    killAndResume(
        [](uint32_t samples) {
            return Strings{"--samples", std::to_string(samples)};
        },
        384, LinkSolver::kMaxSamples, 20, 1);
}

TEST_F(ResumedCommand, KillsChangeNoByteOfPairs) {
    killAndResume(
        [](uint32_t passes) {
            return Strings{"--method", "pure", "--cache", "none", "--passes", std::to_string(passes)};
        },
        3, Solver::kMaxPasses, 6, 2);
}

TEST_F(ResumedCommand, AnInterruptLeavesACheckpointAndNothingElse) {
    const Strings method = {"--samples", "384", "-o", map_};
    ASSERT_EQ(bake(method).status, 0);
    const std::string expected = bytesOf(map_);
    std::filesystem::remove(map_);
    for (const int number : {SIGINT, SIGTERM}) {
        Strings arguments = method;
        arguments.insert(arguments.end(), {
                                              "--checkpoint",
                                              checkpoint_,
                                              "--json",
                                              folder_.path("map.json"),
                                          });
        const ProcessResult r = interrupted(arguments, number);
        EXPECT_EQ(r.status, 1) << r.err;
        EXPECT_TRUE(r.err.ends_with("interrupted: go on with --resume " + checkpoint_ + "\n")) << r.err;
        EXPECT_EQ(folder_.files(), (Strings{"box.glb", "map.checkpoint"}));
        arguments = method;
        arguments.insert(arguments.end(), {"--resume", checkpoint_});
        const ProcessResult second = bake(arguments);
        ASSERT_EQ(second.status, 0) << second.err;
        EXPECT_TRUE(resumed(second)) << second.err;
        EXPECT_EQ(bytesOf(map_), expected);
        EXPECT_EQ(folder_.files(), (Strings{"box.glb", "map.checkpoint", "map.exr"}));
        std::filesystem::remove(map_);
    }
}

TEST_F(ResumedCommand, AFileOfSomethingElseIsRefusedInOneLine) {
    const Strings same = {"--samples", "384"};
    Strings first = same;
    first.insert(first.end(), {"-o", map_, "--checkpoint", checkpoint_});
    ASSERT_EQ(interrupted(first, SIGINT).status, 1);
    ASSERT_TRUE(std::filesystem::exists(checkpoint_));
    const auto refused = [&](const std::string& file, const Strings& more, const std::string& why) {
        Strings arguments = {"--quiet", "bake", scene_, "--size", "64", "-o", map_, "--resume", file};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const ProcessResult r = runRelume(arguments);
        EXPECT_EQ(r.status, 1) << r.err;
        EXPECT_TRUE(contains(r.err, file) && contains(r.err, why)) << r.err;
        EXPECT_EQ(std::count(r.err.begin(), r.err.end(), '\n'), 1) << r.err;
        EXPECT_FALSE(std::filesystem::exists(map_));
    };
    refused(folder_.path("none"), same, "No such file");
    refused(scene_, same, "is no checkpoint");
    refused(checkpoint_, {"--samples", "256"}, "samples=384 there, samples=256 here");
    refused(checkpoint_, {"--samples", "384", "--no-smooth"}, "smooth=1 there, smooth=0 here");
    refused(checkpoint_, {"--samples", "384", "--footprint"}, "footprint=0 there, footprint=1 here");
    refused(checkpoint_, {"--samples", "384", "--reflectivity", "0.5"}, "reflectivity=1 there");
    refused(checkpoint_, {"--samples", "384", "--method", "directional"}, "method=hybrid there");
    const std::string other = tracerName(tracersOfTestDevice().back());
    refused(checkpoint_, {"--samples", "384", "--tracer", other}, "tracer=");
    const std::string half = folder_.path("half");
    const std::string whole = bytesOf(checkpoint_);
    std::ofstream(half, std::ios::binary) << whole.substr(0, whole.size() / 2);
    refused(half, same, "is damaged");
    // A checkpoint does not depend on batches, caches and where the result goes.
    EXPECT_EQ(
        bake({"--samples", "384", "-o", folder_.path("map.png"), "--resume", checkpoint_, "--batch-ms", "3"})
            .status,
        0);
    saveGlb(generateScene("octagon"), scene_);
    refused(checkpoint_, same, "another scene");
    EXPECT_EQ(bake({"-o", map_, "--checkpoint", folder_.path("nowhere/file")}).status, 1);
    EXPECT_EQ(bake({"-o", map_, "--checkpoint", map_}).status, 2);
    EXPECT_EQ(bake({"-o", map_, "--checkpoint-every", "1"}).status, 2);
    EXPECT_EQ(bake({"-o", map_, "--checkpoint", checkpoint_, "--checkpoint-every", "0"}).status, 2);
}

} // namespace relume
