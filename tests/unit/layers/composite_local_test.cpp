// How far texels of a composite are off, from how far the whole is.
#include "bake/layers/composite_report.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace relume {
namespace {

// A normal distribution has 95 % and 99 % of all within so many standard deviations.
constexpr double kOf95 = 1.959964, kOf99 = 2.575829;
// Deviations are counted in bins of a sixteenth of an octave.
constexpr double kBin = 0.03;

constexpr uint32_t kSize = 512; // of the lightmap [texels]

shader::Patch shown() {
    shader::Patch patch{};
    patch.flags = shader::kPatchSends;
    return patch;
}

// The place of a patch where all texels are covered: in tiles of 8 x 8.
uint32_t texelOf(size_t patch) {
    const size_t tile = patch / shader::kChunk, in = patch % shader::kChunk, tiles = kSize / 8;
    return static_cast<uint32_t>((tile / tiles * 8 + in / 8) * kSize + tile % tiles * 8 + in % 8);
}

struct Texels {
    std::vector<glm::vec4> light;
    std::vector<shader::Patch> patches;
    void add(size_t count, float own, float off, const shader::Patch& patch = shown()) {
        light.insert(light.end(), count, glm::vec4(own, own, own, off));
        for (size_t i = 0; i < count; ++i) {
            patches.push_back(patch);
            patches.back().flags |= texelOf(patches.size() - 1) << shader::kTexelShift;
        }
    }
    LocalError at(double error, uint32_t threads = 2) const {
        WorkerPool pool(threads);
        return localErrorOf(pool, light, patches, kSize, error);
    }
};

void expectWithinABin(double value, double wanted) {
    EXPECT_NEAR(value, wanted, kBin * wanted);
}

} // namespace

TEST(CompositeLocalError, IsOfANormalDistribution) {
    Texels texels;
    texels.add(10000, 2.0f, 0.7f); // in any unit: the whole says how much that is
    const LocalError local = texels.at(0.02);
    expectWithinABin(local.p50, 0.674490 * 0.02);
    expectWithinABin(local.p95, kOf95 * 0.02);
    expectWithinABin(local.p99, kOf99 * 0.02);
}

// Nine in ten are as good as exact, so that 95 % of all are those of which half are beyond.
TEST(CompositeLocalError, IsThatOfTheWorstTexels) {
    Texels texels;
    texels.add(9000, 1.0f, 0.0f);
    texels.add(1000, 1.0f, 1.0f);
    const double off = 0.01 * std::sqrt(10.0); // of one in ten, where the root mean square of all is .01
    const LocalError local = texels.at(0.01);
    EXPECT_EQ(local.p50, 0.0);
    expectWithinABin(local.p95, 0.674490 * off);
    expectWithinABin(local.p99, 1.644854 * off);
}

// What is dark is off relative to itself; what is darker than a twentieth of the median, relative to that.
TEST(CompositeLocalError, IsRelativeToTheTexelsOwnLight) {
    const auto darkest = [](float own) {
        Texels texels;
        texels.add(8000, 1.0f, 0.0f);
        texels.add(2000, own, 1.0f);
        const double mean = 0.8 + 0.2 * own, off = 0.001 * mean * std::sqrt(5.0);
        return texels.at(0.001).p95 / (1.150349 * off); // a quarter of these are beyond
    };
    expectWithinABin(darkest(0.1f), 10.0);
    expectWithinABin(darkest(0.05f), 20.0);
    expectWithinABin(darkest(0.001f), 20.0);
}

// One chunk in eight has a bias of twice its noise: 95 % of all are within what the root of both squares
// says.
TEST(CompositeLocalError, HasTheBiasOfSmoothingWhereItIs) {
    Texels texels;
    texels.add(size_t{800} * shader::kChunk, 0.5f, 1.0f);
    WorkerPool pool(2);
    std::vector<double> bias(800, 0.0);
    const double noise = 0.01; // relative
    for (size_t c = 0; c < bias.size(); c += 8)
        bias[c] = shader::kChunk * std::pow(2.0 * noise * 0.5, 2.0);
    const LocalError alone = localErrorOf(pool, texels.light, texels.patches, kSize, noise);
    const LocalError none =
        localErrorOf(pool, texels.light, texels.patches, kSize, noise, std::vector<double>(800, 0.0));
    const LocalError both = localErrorOf(pool, texels.light, texels.patches, kSize, noise, bias);
    EXPECT_EQ(none.p95, alone.p95);
    // Of one in eight with a deviation of 2.236 and seven with 1 a twentieth are beyond 2.396.
    expectWithinABin(both.p95, 2.396 * noise);
    EXPECT_NEAR(both.p50, alone.p50, 0.2 * alone.p50);
}

// Chunks at the edge of a pool of light are half dark. What smoothing moves there lies in the bright half, as
// noise does: for the dark one it would be a hundred times its own light.
TEST(CompositeLocalError, HasNoBiasOfBrightTexelsInDarkOnes) {
    constexpr size_t kChunks = 400;
    Texels texels;
    for (size_t c = 0; c < kChunks; ++c) {
        texels.add(shader::kChunk / 2, 100.0f, 1.0f);
        texels.add(shader::kChunk / 2, 1.0f, 0.01f);
    }
    // Half of all texels are off by the root of two times what all are; biases are as large as the noise.
    const double noise = 0.01, mean = 50.5, off = noise * mean * std::sqrt(2.0), size = off * off;
    const std::vector<double> bias(kChunks, shader::kChunk / 2.0 * size);
    WorkerPool pool(2);
    const LocalError local = localErrorOf(pool, texels.light, texels.patches, kSize, noise, bias);
    EXPECT_NEAR(local.p95, kOf95 * std::sqrt(2.0) * off / 100.0, 0.1 * local.p95);
}

// Replicates of most texels agree by chance, as in the edge of a lamp's shadow: those next to them tell how
// far they are off.
TEST(CompositeLocalError, IsThatOfNeighboursWhereReplicatesAgreeByChance) {
    Texels texels;
    for (size_t i = 0; i < size_t{100} * shader::kChunk; ++i)
        texels.add(1, 1.0f, i % 8 % 3 == 1 && i / 8 % 8 % 3 == 1 ? 3.0f : 0.0f); // no two of them touch
    const double share = 9.0 / 64, off = 0.01 / std::sqrt(share); // of those that tell something
    const LocalError local = texels.at(0.01);
    // Each texel has one of them among its neighbours, which are nine, six or four.
    EXPECT_GT(local.p50, 0.6 * off / 3.0);
    EXPECT_LT(local.p95, 2.0 * off / 2.0);
}

// Two surfaces have a chunk in common, with hundreds of texels of the lightmap between them.
TEST(CompositeLocalError, IsNotThatOfTexelsElsewhere) {
    Texels texels;
    for (size_t i = 0; i < size_t{100} * shader::kChunk; ++i) {
        texels.add(1, 1.0f, i % 2 == 0 ? 1.0f : 0.0f);
        if (i % 2 == 0) texels.patches.back().flags ^= (kSize / 2 * kSize) << shader::kTexelShift;
    }
    const LocalError local = texels.at(0.01);
    EXPECT_EQ(local.p50, 0.0);
}

TEST(CompositeLocalError, LeavesOutWhatIsNotShown) {
    Texels texels;
    texels.add(1000, 1.0f, 1.0f);
    const double alone = texels.at(0.01).p95;
    shader::Patch hidden = shown();
    hidden.flags |= shader::kPatchBackSide;
    texels.add(5000, 0.01f, 50.0f, hidden);
    EXPECT_EQ(texels.at(0.01).p95, alone);
}

TEST(CompositeLocalError, IsNoneWhereNothingIsLitOrOff) {
    Texels dark, exact;
    dark.add(100, 0.0f, 0.0f);
    exact.add(100, 1.0f, 0.0f);
    EXPECT_EQ(dark.at(0.0).p99, 0.0);
    EXPECT_EQ(exact.at(0.0).p99, 0.0);
    EXPECT_EQ(Texels().at(0.01).p95, 0.0);
}

TEST(CompositeLocalError, IsTheSameOnAnyNumberOfThreads) {
    Texels texels;
    for (int i = 1; i < 20000; ++i)
        texels.add(1, 0.001f * static_cast<float>(i), 0.1f + 0.37f * static_cast<float>(i % 11));
    const LocalError one = texels.at(0.01, 1), five = texels.at(0.01, 5);
    EXPECT_EQ(one.p50, five.p50);
    EXPECT_EQ(one.p95, five.p95);
}

} // namespace relume
