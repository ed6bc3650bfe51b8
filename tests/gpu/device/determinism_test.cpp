// One scene, one tracer and one device give the same bytes, whatever the batches, the timing and the number
// of threads.
#include "assets/generate/generate.h"
#include "bake/trace/make_tracer.h"
#include "tests/gpu/bake_scene.h"
#include "tests/gpu/gpu_environment.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <optional>

namespace relume {
namespace {

// Sets the number of threads while it lives.
class ThreadCount {
public:
    explicit ThreadCount(const char* count) {
        if (const char* old = std::getenv("RELUME_THREADS")) old_ = old;
        setenv("RELUME_THREADS", count, 1);
    }
    ~ThreadCount() {
        if (old_)
            setenv("RELUME_THREADS", old_->c_str(), 1);
        else
            unsetenv("RELUME_THREADS");
    }

private:
    std::optional<std::string> old_;
};

void expectSameBytes(const FloatImage& a, const FloatImage& b) {
    ASSERT_EQ(a.channels, b.channels);
    for (size_t k = 0; k < a.planes.size(); ++k) {
        ASSERT_EQ(a.planes[k].size(), b.planes[k].size());
        EXPECT_EQ(std::memcmp(a.planes[k].data(), b.planes[k].data(), a.planes[k].size() * sizeof(float)), 0)
            << "channel " << a.channels[k];
    }
}

} // namespace

class Determinism : public testing::TestWithParam<TracerKind> {};

// A viewer looks at the light after every batch.
TEST(Determinism, LookingAtTheLightChangesNoByte) {
    const Scene scene = generateScene("cornell_geom");
    for (const BakeDesc& desc :
         {BakeDesc{.size = 48, .passes = 0, .error = 0.03, .method = Method::Hybrid, .smooth = true},
          BakeDesc{.size = 48, .passes = 0, .method = Method::Hybrid, .samples = 64, .smooth = true},
          BakeDesc{.size = 48, .passes = 3}}) {
        const Baked unseen = bakeScene(scene, desc);
        const std::unique_ptr<Baker> baker = makeBaker(scene, desc);
        uint32_t changes = 0;
        std::vector<glm::vec4> shown;
        while (!baker->solver().done()) {
            baker->solver().step();
            const std::vector<glm::vec4>& light = baker->solver().light();
            if (light != shown) ++changes;
            shown = light;
        }
        EXPECT_GT(changes, 2u); // it converges before one's eyes
        expectSameBytes(baker->lightmap({.quantity = Quantity::Lighting, .sew = false}), unseen.lighting);
        EXPECT_EQ(baker->solver().progress().error, unseen.progress.error);
    }
}

TEST_P(Determinism, TwoRunsAndSmallBatchesGiveTheSameBytes) {
    const std::vector<TracerKind> kinds = tracersOfTestDevice();
    if (std::find(kinds.begin(), kinds.end(), GetParam()) == kinds.end())
        GTEST_SKIP() << tracerName(GetParam()) << " does not run on this device";
    const Scene scene = generateScene("cornell_geom");
    // There is more than one super-block row, so that batches can be cut in many ways.
    const BakeDesc desc{.size = 48, .tracer = GetParam(), .passes = 3};
    const Baked first = bakeScene(scene, desc);
    ASSERT_GT(first.patches.chunkCount(), shader::kSuper);
    EXPECT_GT(statistics(first.lighting, {0, 0, 48, 48}).mean, 0.1);
    expectSameBytes(first.lighting, bakeScene(scene, desc).lighting);
    BakeDesc small = desc;
    small.batchMs = desc.batchMs / 10;
    const Baked inPieces = bakeScene(scene, small);
    expectSameBytes(first.lighting, inPieces.lighting);
    EXPECT_EQ(first.progress.rays, inPieces.progress.rays);
    EXPECT_EQ(first.progress.pairs, inPieces.progress.pairs);
}

INSTANTIATE_TEST_SUITE_P(Tracers, Determinism,
                         testing::Values(TracerKind::Embree, TracerKind::Bvh, TracerKind::Query,
                                         TracerKind::Rtp),
                         [](const auto& test) { return std::string(tracerName(test.param)); });

TEST(Determinism, NumberOfThreadsGivesTheSameBytes) {
    if (!tracerProblem(TracerKind::Embree, testDevice().info()).empty())
        GTEST_SKIP() << "embree does not run on this device";
    const Scene scene = generateScene("cornell_geom");
    std::vector<FloatImage> maps;
    for (const char* threads : {"1", "2", "5"}) {
        const ThreadCount count(threads);
        const vk::Device device({.select = std::to_string(testDevice().info().index), .validation = true});
        EXPECT_EQ(device.workers().size(), std::stoul(threads));
        maps.push_back(
            bakeScene(scene, {.size = 64, .tracer = TracerKind::Embree, .passes = 2, .device = &device})
                .lighting);
    }
    expectSameBytes(maps[0], maps[1]);
    expectSameBytes(maps[0], maps[2]);
}

// A bounce ends at the same light whether the aim is a number of bounces or an error.
TEST(Determinism, PassesAreTheSameWhateverEndsThem) {
    const Scene scene = generateScene("cornell_geom");
    const Baked byError = bakeScene(scene, {.size = 32, .passes = 0, .error = 0.05});
    ASSERT_TRUE(byError.progress.converged);
    const Baked byPasses = bakeScene(scene, {.size = 32, .passes = byError.progress.passes});
    EXPECT_FALSE(byPasses.progress.converged);
    EXPECT_EQ(byError.progress.passes, byPasses.progress.passes);
    EXPECT_EQ(byError.progress.passSeconds.size(), byError.progress.passes);
    expectSameBytes(byError.lighting, byPasses.lighting);
}

} // namespace relume
