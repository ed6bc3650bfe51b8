// A viewer looks on, moves its camera, changes the budget and aborts bounces. None of it changes what comes
// out of a solver.
#include "assets/generate/generate.h"
#include "bake/output/checkpoint.h"
#include "tests/gpu/bake_comparison.h"
#include "tests/gpu/bake_scene.h"
#include "tests/gpu/gpu_environment.h"
#include "tests/gpu/relume_process.h"
#include "tests/temporary_folder.h"

#include <gtest/gtest.h>

#include <random>

namespace relume {
namespace {

struct LiveSolverCase {
    const char* name;
    BakeDesc desc;
};

class LiveSolver : public testing::TestWithParam<LiveSolverCase> {};

FloatImage mapOf(const Baker& baker) {
    return baker.lightmap({.quantity = Quantity::Radiance, .sew = false});
}

struct Undisturbed {
    FloatImage map;
    SolverProgress progress;
};

Undisturbed bakeUndisturbed(const Scene& scene, const BakeDesc& desc) {
    const auto baker = makeBaker(scene, desc);
    while (!baker->solver().done())
        baker->solver().step();
    return {mapOf(*baker), baker->solver().progress()};
}

bool isPair(const LiveSolverCase& which) {
    return isPairMethod(which.desc.method);
}

// Pair methods add up in another order where the camera says what comes first.
void expectSameLight(const FloatImage& a, const FloatImage& b, bool sameOrder) {
    if (sameOrder)
        EXPECT_TRUE(sameBytes(a, b));
    else
        EXPECT_LT(relativeError(a, b), 1e-5);
}

// Stands for the display: it copies what it is told has changed.
class Display {
public:
    explicit Display(const Baker& baker) : light_(baker.patches().scene.patches.size()) {}
    /// Returns whether anything new came, and checks that nothing else has.
    bool look(Solver& solver) {
        const LiveLight live = solver.liveLight();
        missed_.insert(missed_.end(), live.changed.begin(), live.changed.end());
        if (live.light == nullptr) {
            EXPECT_FALSE(looked_) << "there was light before";
            return !live.changed.empty();
        }
        const std::vector<glm::vec4> now =
            vk::readBuffer<glm::vec4>(testDevice(), *live.light, light_.size());
        for (const ChunkRange& range : std::exchange(missed_, {})) {
            const size_t first = size_t{range.first} * shader::kChunk, count = range.count * shader::kChunk;
            std::copy_n(now.begin() + static_cast<ptrdiff_t>(first), count,
                        light_.begin() + static_cast<ptrdiff_t>(first));
        }
        EXPECT_EQ(live.changed, merged(live.changed));
        if (looked_) {
            EXPECT_EQ(live.version != version_, !live.changed.empty());
        }
        EXPECT_TRUE(live.complete || !complete_) << "complete, and then not";
        bool same = true;
        for (size_t i = 0; i < now.size(); ++i)
            same = same && glm::vec3(now[i]) == glm::vec3(light_[i]);
        EXPECT_TRUE(same) << "chunks changed that are not named";
        complete_ = live.complete;
        version_ = live.version;
        looked_ = true;
        return !live.changed.empty();
    }
    /// The first pass was aborted: there may be no light to look at once more.
    void beginAnew() { looked_ = false; }
    bool complete() const { return complete_; }
    /// Returns the mean over patches that are shown, weighted alike.
    double mean(const PatchSet& patches) const { return meanOf(light_, patches); }
    static double meanOf(const std::vector<glm::vec4>& light, const PatchSet& patches) {
        double sum = 0, count = 0;
        for (uint32_t i = 0; i < patches.count; ++i) {
            if ((patches.scene.patches[i].flags & shader::kPatchBackSide) != 0) continue;
            sum += double{light[i].r} + light[i].g + light[i].b;
            count += 3;
        }
        return sum / count;
    }
    void expectShows(const std::vector<glm::vec4>& light) const {
        for (size_t i = 0; i < light.size(); ++i)
            ASSERT_EQ(glm::vec3(light_[i]), glm::vec3(light[i])) << i;
    }

private:
    std::vector<glm::vec4> light_;
    std::vector<ChunkRange> missed_; // while there was no light to look at
    uint64_t version_ = 0;
    bool complete_ = false, looked_ = false;
};

std::vector<uint8_t> randomChunks(const Baker& baker, std::mt19937& random) {
    std::vector<uint8_t> seen(baker.patches().chunkCount());
    for (uint8_t& s : seen)
        s = random() % 3 == 0;
    return random() % 5 == 0 ? std::vector<uint8_t>{} : seen;
}

} // namespace

TEST_P(LiveSolver, LookingOnChangesNoByte) {
    const Scene scene = generateScene("cornell_geom");
    BakeDesc desc = GetParam().desc;
    const Undisturbed straight = bakeUndisturbed(scene, desc);
    desc.live = true;
    desc.batchMs = 0.5;
    const auto baker = makeBaker(scene, desc);
    Solver& solver = baker->solver();
    Display display(*baker);
    std::mt19937 random(3);
    uint32_t news = 0;
    while (!solver.done()) {
        solver.step();
        if (random() % 2 == 0) news += display.look(solver);
        if (random() % 4 == 0) solver.setBatchMs(random() % 2 == 0 ? 0.2 : 2.0);
    }
    display.look(solver);
    EXPECT_GE(news, 2u);
    EXPECT_TRUE(display.complete());
    EXPECT_TRUE(sameBytes(mapOf(*baker), straight.map));
    display.expectShows(solver.light());
    EXPECT_EQ(solver.progress().error, straight.progress.error);
    EXPECT_EQ(solver.progress().passes, straight.progress.passes);
}

TEST_P(LiveSolver, AMovingCameraChangesTheOrderOnly) {
    const Scene scene = generateScene("cornell_geom");
    BakeDesc desc = GetParam().desc;
    const Undisturbed straight = bakeUndisturbed(scene, desc);
    desc.live = true;
    desc.batchMs = 0.2;
    const auto baker = makeBaker(scene, desc);
    Solver& solver = baker->solver();
    Display display(*baker);
    std::mt19937 random(5);
    while (!solver.done()) {
        if (random() % 3 == 0) solver.setPriority(randomChunks(*baker, random));
        solver.step();
        display.look(solver);
    }
    expectSameLight(mapOf(*baker), straight.map, !isPair(GetParam()));
    display.expectShows(solver.light());
    EXPECT_EQ(solver.progress().pairs, straight.progress.pairs);
}

// A bounce or sample pass is aborted at any moment, with and without what aborting at once takes.
TEST_P(LiveSolver, AnAbortedPassLeavesNoTrace) {
    const Scene scene = generateScene("cornell_geom");
    BakeDesc desc = GetParam().desc;
    const Undisturbed straight = bakeUndisturbed(scene, desc);
    desc.batchMs = 0.2;
    for (const bool live : {true, false}) {
        desc.live = live;
        const auto baker = makeBaker(scene, desc);
        Solver& solver = baker->solver();
        Display display(*baker);
        std::mt19937 random(11);
        uint32_t aborted = 0, within = 0; // a pass
        std::vector<glm::vec4> before = solver.light();
        while (!solver.done()) {
            solver.step();
            within += solver.passBoundary() ? 0 : 1;
            if (live) display.look(solver);
            if (solver.passBoundary()) before = solver.light();
            // A GPU makes a pass in few steps: the first ones within a pass are all aborted there.
            const uint32_t every = testDevice().info().software() ? 10 : 1;
            if (aborted == 15 || random() % every != 0 || solver.passBoundary()) continue;
            solver.abortPass();
            ++aborted;
            EXPECT_TRUE(solver.passBoundary());
            if (!live) continue;
            if (solver.progress().passes == 0) display.beginAnew();
            display.look(solver);
            EXPECT_EQ(solver.light(), before);
        }
        EXPECT_TRUE(sameBytes(mapOf(*baker), straight.map)) << "live: " << live;
        EXPECT_EQ(solver.progress().passes, straight.progress.passes);
        EXPECT_EQ(solver.progress().samples, straight.progress.samples);
        EXPECT_EQ(solver.progress().error, straight.progress.error);
        if (within == 0 && !testDevice().info().software())
            GTEST_SKIP() << "this GPU makes each pass in one step: there is nothing to abort";
        EXPECT_GE(aborted, testDevice().info().software() ? 3u : 1u); // else it was no test
    }
}

// The checkpoint comes in the middle of a sample pass, and each solver has a camera of its own.
TEST_P(LiveSolver, ACheckpointKeepsWhatIsDone) {
    const TemporaryFolder folder;
    const std::string file = folder.path("checkpoint");
    const Scene scene = generateScene("cornell_geom");
    const CheckpointKey key = {"1", GetParam().name, 1};
    BakeDesc desc = GetParam().desc;
    const Undisturbed straight = bakeUndisturbed(scene, desc);
    desc.batchMs = 0.2;
    desc.live = true;
    std::mt19937 random(17);
    auto baker = makeBaker(scene, desc);
    auto display = std::make_unique<Display>(*baker);
    for (uint32_t steps = 1; !baker->solver().done(); steps *= 2) {
        baker->solver().setPriority(randomChunks(*baker, random));
        for (uint32_t i = 0; i < steps && !baker->solver().done(); ++i) {
            baker->solver().step();
            display->look(baker->solver());
        }
        if (baker->solver().done()) break;
        saveCheckpoint(file, key, baker->solver());
        baker = makeBaker(scene, desc);
        display = std::make_unique<Display>(*baker);
        Checkpoint(file, key.version).restore(key, baker->solver());
    }
    expectSameLight(mapOf(*baker), straight.map, !isPair(GetParam()));
    display->expectShows(baker->solver().light());
    EXPECT_EQ(baker->solver().progress().pairs, straight.progress.pairs);
}

INSTANTIATE_TEST_SUITE_P(
    Methods, LiveSolver,
    testing::Values(
        LiveSolverCase{"hybrid",
                       {.size = 48, .passes = 0, .error = 0.03, .method = Method::Hybrid, .smooth = true}},
        LiveSolverCase{"hybridSamples", {.size = 48, .passes = 0, .method = Method::Hybrid, .samples = 48}},
        LiveSolverCase{"hybridPasses",
                       {.size = 48, .passes = 4, .method = Method::Hybrid, .samples = 48, .smooth = true}},
        LiveSolverCase{"hybridDirect", {.size = 48, .passes = 1, .method = Method::Hybrid, .samples = 64}},
        LiveSolverCase{"coarse",
                       {.size = 48,
                        .passes = 0,
                        .method = Method::Hybrid,
                        .samples = 48,
                        .smooth = true,
                        .indirectScale = 2}},
        LiveSolverCase{"directional", {.size = 48, .passes = 0, .error = 0.2, .method = Method::Directional}},
        LiveSolverCase{"pure", {.size = 48, .passes = 3, .method = Method::Pure}},
        LiveSolverCase{"preset", {.size = 48, .passes = 3, .method = Method::Pure, .rtrad = true}},
        LiveSolverCase{"montecarlo",
                       {.size = 64, .passes = 3, .method = Method::MonteCarlo, .pairs = {.window = 2}}},
        LiveSolverCase{"adaptive",
                       {.size = 64, .passes = 3, .method = Method::Adaptive, .pairs = {.threshold = 0.02}}},
        LiveSolverCase{"pureError", {.size = 32, .passes = 0, .error = 0.02, .method = Method::Pure}}),
    [](const auto& test) { return std::string(test.param.name); });

namespace {

void expectCompleteIsNearTheEnd(const Scene& scene, BakeDesc desc) {
    desc.size = 64;
    desc.batchMs = 1;
    desc.live = true;
    const auto baker = makeBaker(scene, desc);
    Display display(*baker);
    std::vector<double> means; // since it is complete
    while (!baker->solver().done()) {
        baker->solver().step();
        display.look(baker->solver());
        if (display.complete()) means.push_back(display.mean(baker->patches()));
    }
    const double end = Display::meanOf(baker->solver().light(), baker->patches());
    EXPECT_GT(means.size(), testDevice().info().software() ? 2u : 1u)
        << methodName(desc.method); // not only at the end
    for (const double mean : means)
        ASSERT_NEAR(mean, end, 0.02 * end) << methodName(desc.method);
}

} // namespace

TEST(LiveLight, CompleteIsHardlyDimmerThanTheEnd) {
    const Scene scene = generateScene("cornell_geom");
    expectCompleteIsNearTheEnd(scene, {.passes = 0, .error = 0.03, .method = Method::Hybrid});
    expectCompleteIsNearTheEnd(scene, {.passes = 4, .method = Method::Hybrid, .samples = 64});
    expectCompleteIsNearTheEnd(scene, {.passes = 0, .error = 0.002});
    expectCompleteIsNearTheEnd(
        scene, {.passes = 0, .error = 0.002, .method = Method::Mipmapped, .pairs = {.window = 2}});
}

// Bounces go on for long here. A whole wall shines, so that directions find it alike in every sample pass.
TEST(LiveLight, CompleteIsHardlyDimmerThanTheEndOfManyBounces) {
    const glm::vec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
    SceneMaker maker(64);
    std::array<int, 6> materials;
    materials.fill(maker.material(0.8f));
    materials[4] = maker.material(0.8f, 1.0f);
    std::array<glm::uvec2, 6> texels;
    texels.fill(glm::uvec2(16));
    maker.box({0, 0, 0}, {4.0f * x, 1.0f * y, 1.0f * z}, materials, texels);
    expectCompleteIsNearTheEnd(maker.scene(), {.passes = 0, .error = 0.01, .method = Method::Hybrid});
    expectCompleteIsNearTheEnd(maker.scene(), {.passes = 0, .error = 0.03, .method = Method::Directional});
    expectCompleteIsNearTheEnd(maker.scene(), {.passes = 0, .error = 0.002});
    expectCompleteIsNearTheEnd(
        maker.scene(), {.passes = 0, .error = 0.002, .method = Method::Static, .pairs = {.window = 2}});
}

TEST(LiveLight, WhatIsSeenComesFirst) {
    const Scene scene = generateScene("cornell_geom");
    {
        const auto baker = makeBaker(
            scene, {.size = 64, .passes = 0, .method = Method::Hybrid, .samples = 16, .live = true});
        Solver& solver = baker->solver();
        ASSERT_GT(baker->patches().chunkCount(), 33u);
        std::vector<uint8_t> seen(baker->patches().chunkCount(), 0);
        seen[31] = seen[32] = 1;
        solver.liveLight();
        solver.setPriority(seen);
        solver.step();
        const LiveLight lit = solver.liveLight();
        EXPECT_EQ(lit.changed, (std::vector<ChunkRange>{{31, 2}}));
        EXPECT_NE(lit.light, nullptr);
        std::fill(seen.begin(), seen.end(), uint8_t{1});
        solver.setPriority(seen);
        EXPECT_NE(solver.liveLight().light, nullptr) << "the camera turns to what is not lit yet";
        solver.step();
        EXPECT_EQ(solver.liveLight().changed.front().first, 0u);
    }
    for (const Method method : {Method::Pure, Method::Static}) {
        const auto baker = makeBaker(scene, {.size = 96,
                                             .passes = 2,
                                             .batchMs = 0.2,
                                             .method = method,
                                             .pairs = {.window = 2},
                                             .live = true});
        Solver& solver = baker->solver();
        std::vector<uint8_t> seen(baker->patches().chunkCount(), 0);
        ASSERT_GT(seen.size(), 3 * shader::kSuper);
        seen[2 * shader::kSuper + 3] = 1;
        solver.setPriority(seen);
        std::vector<ChunkRange> changed;
        solver.liveLight();
        while (!solver.done() && changed.empty()) {
            solver.step();
            changed = solver.liveLight().changed;
        }
        ASSERT_FALSE(changed.empty());
        EXPECT_TRUE(std::any_of(changed.begin(), changed.end(), [](const ChunkRange& range) {
            return range.first <= 2 * shader::kSuper && 3 * shader::kSuper <= range.first + range.count;
        })) << methodName(method);
        EXPECT_FALSE(solver.passBoundary());
    }
}

TEST(LiveLight, TheBudgetHoldsFromTheNextStepOn) {
    const Scene scene = generateScene("cornell_geom");
    if (!testDevice().info().software())
        GTEST_SKIP() << "a GPU makes these passes in a few steps, whatever their budget";
    for (const BakeDesc& desc : {BakeDesc{.size = 64, .passes = 3},
                                 BakeDesc{.size = 64, .method = Method::Directional, .samples = 64}}) {
        const auto steps = [&](double ms) {
            const auto baker = makeBaker(scene, desc);
            baker->solver().step();
            baker->solver().setBatchMs(ms);
            uint32_t count = 1;
            for (; !baker->solver().done(); ++count)
                baker->solver().step();
            return count;
        };
        EXPECT_GT(steps(0.1), 3 * steps(30.0));
    }
}

} // namespace relume
