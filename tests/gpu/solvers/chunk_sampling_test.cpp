// Chunks have sample passes of their own: where light is off relative to itself more samples are taken,
// without a byte that hangs on batches, and without a bias.
#include "assets/generate/generate.h"
#include "assets/images/metrics.h"
#include "tests/gpu/bake_scene.h"

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace relume {
namespace {

constexpr uint32_t kRoomSize = 48;

// Two rooms beside each other: a lamp lights one of them, and a gap in the wall between lets some of it into
// the other.
Scene darkRoom() {
    SceneMaker maker(kRoomSize);
    const int grey = maker.material(0.6f), lamp = maker.material(0.0f, 40.0f);
    maker.box({0, 0, 0}, {6.0f * kX, 3.0f * kY, 3.0f * kZ}, grey, 10);
    maker.quad({1, 2.99f, 1}, 0.6f * kX, 0.6f * kZ, lamp, {2, 2});
    maker.quad({3, 0, 0}, 2.4f * kY, 3.0f * kZ, grey, {8, 8});
    maker.quad({2.98f, 0, 0}, 3.0f * kZ, 2.4f * kY, grey, {8, 8});
    return maker.scene();
}

BakeDesc localOnly(double localError, bool perChunk) {
    return {.size = kRoomSize,
            .passes = 0,
            .localError = localError,
            .perChunk = perChunk,
            .method = Method::Hybrid,
            .smooth = true};
}

BakeDesc reference(uint32_t samples) {
    return {.size = kRoomSize, .passes = 0, .method = Method::Hybrid, .samples = samples};
}

LocalPercentiles localOf(const FloatImage& map, const FloatImage& truth) {
    const ImagePair pair({map, "map"}, {truth, "truth"});
    return pair.percentiles(pair.localErrors());
}

// Returns the mean of R, G and B over the quarter of the texels that is darkest in `truth`.
double meanOfDarkest(const FloatImage& map, const FloatImage& truth) {
    const auto light = [](const FloatImage& image, size_t i) {
        return double{(*image.find("R"))[i]} + (*image.find("G"))[i] + (*image.find("B"))[i];
    };
    std::vector<size_t> texels;
    for (size_t i = 0; i < truth.find("R")->size(); ++i)
        if ((*truth.find("coverage"))[i] == 1.0f) texels.push_back(i);
    std::sort(texels.begin(), texels.end(),
              [&](size_t a, size_t b) { return light(truth, a) < light(truth, b); });
    texels.resize(texels.size() / 4);
    double sum = 0;
    for (const size_t i : texels)
        sum += light(map, i);
    return sum / static_cast<double>(texels.size());
}

// A room with a lamp close to a corner: chunks there need far more of its light's samples than all others.
Scene lampInTheCorner() {
    SceneMaker maker(kRoomSize);
    maker.box({0, 0, 0}, {4.0f * kX, 3.0f * kY, 4.0f * kZ}, maker.material(0.5f), 12);
    maker.blocker({0.1f, 0.5f, 0.1f}, 0.2f * kX, 0.2f * kZ, maker.material(0.5f));
    Scene scene = maker.scene();
    Light lamp;
    lamp.transform = glm::translate(glm::mat4(1.0f), {0.25f, 0.8f, 0.25f});
    lamp.radius = 0.1f;
    lamp.intensity = 30.0f;
    scene.lights.push_back(lamp);
    return scene;
}

// Bakes step by step, with these chunks first.
FloatImage lookedAt(Baker& baker, uint32_t everySoManyChunks) {
    std::vector<uint8_t> seen(baker.patches().chunkCount(), 0);
    for (size_t i = 0; i < seen.size(); i += everySoManyChunks)
        seen[i] = 1;
    baker.solver().setPriority(seen);
    while (!baker.solver().done())
        baker.solver().step();
    return baker.lightmap({.quantity = Quantity::Lighting, .sew = false});
}

void expectSameBytes(const FloatImage& a, const FloatImage& b) {
    ASSERT_EQ(a.planes.size(), b.planes.size());
    for (size_t k = 0; k < a.planes.size(); ++k)
        EXPECT_EQ(a.planes[k], b.planes[k]) << a.channels[k];
}

} // namespace

class ChunkSampling : public testing::Test {
protected:
    static void SetUpTestSuite() {
        scene_ = new Scene(darkRoom());
        truth_ = new Baked(bakeScene(*scene_, reference(16384)));
    }
    static void TearDownTestSuite() {
        delete scene_;
        delete truth_;
    }

    static inline Scene* scene_ = nullptr;
    static inline Baked* truth_ = nullptr; // by samples alone, which go to every patch alike
};

TEST_F(ChunkSampling, EndsWhereTheLocalErrorIsReached) {
    for (const bool perChunk : {false, true}) {
        const Baked coarse = bakeScene(*scene_, localOnly(0.2, perChunk));
        const Baked fine = bakeScene(*scene_, localOnly(0.05, perChunk));
        EXPECT_TRUE(coarse.progress.converged && fine.progress.converged);
        EXPECT_LE(coarse.progress.localError95, 0.2);
        EXPECT_LE(fine.progress.localError95, 0.05);
        EXPECT_GT(fine.progress.rays, 2 * coarse.progress.rays);
        EXPECT_LT(localOf(fine.lighting, truth_->lighting).p95,
                  0.6 * localOf(coarse.lighting, truth_->lighting).p95);
    }
}

// The error that is told is the one that is left, smoothed or not. Here light comes into the dark room by two
// bounces, so that noise of what links read, which replicates share, is a part of it.
TEST_F(ChunkSampling, TellsTheLocalErrorThatIsThere) {
    for (const bool perChunk : {false, true})
        for (const bool smooth : {false, true}) {
            BakeDesc desc = localOnly(0.1, perChunk);
            desc.smooth = smooth;
            const Baked baked = bakeScene(*scene_, desc);
            const LocalPercentiles truly = localOf(baked.lighting, truth_->lighting);
            EXPECT_NEAR(baked.progress.localError95 / truly.p95, 1.0, 0.3) << perChunk << smooth;
            EXPECT_NEAR(baked.progress.localError99 / truly.p99, 1.0, 0.4) << perChunk << smooth;
        }
}

// To stop by an estimate must not choose what is dark by chance. The mean over the darkest quarter is of
// hundreds of independent texels, so it is known far better than any of them.
TEST_F(ChunkSampling, DarkPlacesAreNoDarkerForIt) {
    BakeDesc desc = localOnly(0.05, true);
    desc.smooth = false;
    const Baked baked = bakeScene(*scene_, desc);
    const double truly = meanOfDarkest(truth_->lighting, truth_->lighting);
    EXPECT_NEAR(meanOfDarkest(baked.lighting, truth_->lighting) / truly, 1.0, 0.02);
}

TEST_F(ChunkSampling, BatchesAndWhatIsSeenChangeNoByte) {
    BakeDesc desc = localOnly(0.1, true);
    const Baked baked = bakeScene(*scene_, desc);
    desc.batchMs = 0.3;
    desc.cache.kind = CacheSettings::Kind::None;
    const std::unique_ptr<Baker> baker = makeBaker(*scene_, desc);
    expectSameBytes(lookedAt(*baker, 3), baked.lighting);
}

// Chunks that want more direct light are wherever they are, and kernels and the CPU find them by a list.
TEST_F(ChunkSampling, ListedChunksGetTheSameDirectLightInAnyPortion) {
    const Scene scene = lampInTheCorner();
    const FloatImage truth = bakeScene(scene, reference(8192)).lighting;
    for (const TracerKind tracer : tracersOfTestDevice()) {
        constexpr double asked = 0.05;
        BakeDesc desc = localOnly(asked, false);
        desc.tracer = tracer;
        const std::unique_ptr<Baker> baker = makeBaker(scene, desc);
        const FloatImage baked = lookedAt(*baker, 1);
        const SolverProgress progress = baker->solver().progress();
        ASSERT_TRUE(progress.converged);
        desc.batchMs = 0.5;
        const std::unique_ptr<Baker> other = makeBaker(scene, desc);
        expectSameBytes(lookedAt(*other, 3), baked);
        EXPECT_EQ(other->solver().progress().rays, progress.rays);
        desc.live = true;
        const std::unique_ptr<Baker> live = makeBaker(scene, desc);
        expectSameBytes(lookedAt(*live, 5), baked);
        EXPECT_LE(localOf(baked, truth).p95, asked);
    }
}

// A number of samples is a limit for every chunk, and ends a bake that cannot reach its error.
TEST_F(ChunkSampling, SamplesAreALimit) {
    BakeDesc desc = localOnly(0.001, true);
    desc.samples = 64;
    const Baked baked = bakeScene(*scene_, desc);
    EXPECT_FALSE(baked.progress.converged);
    EXPECT_LE(baked.progress.samples, 64u);
    EXPECT_GT(baked.progress.localError95, 0.001);
}

} // namespace relume
