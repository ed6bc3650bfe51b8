// To stop by an estimate must not select. The numbers that samples are made of depend on the texel alone, so
// the same room elsewhere in a larger lightmap is the same bake with other seeds; the mean of many is held
// against one long bake, the dark texels too.
#include "assets/images/metrics.h"
#include "tests/gpu/bake_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace relume {
namespace {

constexpr uint32_t kRoom = 80, kMap = 192; // edges of the room's charts and of the lightmap [texels]
constexpr uint32_t kStep = 16;             // the room is moved by whole tiles [texels]
constexpr uint32_t kSteps = 8;             // both ways
constexpr uint32_t kLong = 32768;          // directions of the long bake

// Two rooms beside each other: a lamp lights one of them, and a gap in the wall between lets some of it into
// the other.
Scene roomAt(uint32_t column, uint32_t row) {
    SceneMaker maker(kRoom);
    const int grey = maker.material(0.6f), lamp = maker.material(0.0f, 40.0f);
    maker.box({0, 0, 0}, {6.0f * kX, 3.0f * kY, 3.0f * kZ}, grey, 16);
    maker.quad({1, 2.99f, 1}, 0.6f * kX, 0.6f * kZ, lamp, {4, 4});
    maker.quad({3, 0, 0}, 2.25f * kY, 3.0f * kZ, grey, {12, 12});
    maker.quad({2.98f, 0, 0}, 3.0f * kZ, 2.25f * kY, grey, {12, 12});
    Scene scene = maker.scene();
    const glm::vec2 offset = static_cast<float>(kStep) * glm::vec2(column, row);
    for (Mesh& mesh : scene.meshes)
        for (Primitive& primitive : mesh.primitives)
            for (glm::vec2& uv : primitive.texCoord1)
                uv = (static_cast<float>(kRoom) * uv + offset) / static_cast<float>(kMap);
    return scene;
}

// Returns the light of the room's texels, row by row, 0 where none is covered.
std::vector<double> lightOf(const FloatImage& map, uint32_t column, uint32_t row) {
    std::vector<double> light;
    for (uint32_t y = 0; y < kRoom; ++y)
        for (uint32_t x = 0; x < kRoom; ++x) {
            const size_t i = size_t{row * kStep + y} * kMap + column * kStep + x;
            const bool covered = (*map.find("coverage"))[i] == 1.0f;
            light.push_back(
                covered ? (double{(*map.find("R"))[i]} + (*map.find("G"))[i] + (*map.find("B"))[i]) / 3
                        : 0.0);
        }
    return light;
}

BakeDesc untilClean(bool perChunk, bool layers) {
    return {.size = kMap,
            .passes = 0,
            .error = 0.02,
            .localError = 0.1,
            .perChunk = perChunk,
            .method = Method::Hybrid,
            .layers = layers};
}

/// A mean of independent values, and how far it is off by chance.
struct Estimate {
    double mean = 0, error = 0;
};
Estimate estimate(const std::vector<double>& values) {
    const double n = static_cast<double>(values.size());
    const double mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
    double squares = 0;
    for (const double value : values)
        squares += (value - mean) * (value - mean);
    return {mean, std::sqrt(squares / (n - 1) / n)};
}

} // namespace

class Seeds : public testing::Test {
protected:
    static void SetUpTestSuite() {
        BakeDesc desc{.size = kMap, .passes = 0, .method = Method::Hybrid, .samples = kLong};
        truth_ = lightOf(bakeScene(roomAt(0, 0), desc).lighting, 0, 0);
        for (size_t i = 0; i < truth_.size(); ++i)
            if (truth_[i] > 0) texels_.push_back(i);
        std::sort(texels_.begin(), texels_.end(), [](size_t a, size_t b) { return truth_[a] < truth_[b]; });
    }

    // Expects that means over many seeds are the truth, within what chance explains.
    static void expectTruth(const BakeDesc& desc) {
        std::vector<std::vector<double>> bakes;
        double samples = 0;
        for (uint32_t row = 0; row < kSteps; ++row)
            for (uint32_t column = 0; column < kSteps; ++column) {
                const Baked baked = bakeScene(roomAt(column, row), desc);
                bakes.push_back(lightOf(baked.lighting, column, row));
                samples += baked.progress.samples;
            }
        // The long bake is off by chance, too: as one of as many samples is that all of these have together.
        const double both = std::sqrt(1.0 + samples / kLong);
        const size_t quarter = texels_.size() / 4;
        for (size_t first = 0; first + quarter <= texels_.size(); first += quarter) {
            double truly = 0;
            std::vector<double> means(bakes.size(), 0.0);
            for (size_t k = first; k < first + quarter; ++k) {
                truly += truth_[texels_[k]];
                for (size_t bake = 0; bake < bakes.size(); ++bake)
                    means[bake] += bakes[bake][texels_[k]];
            }
            const Estimate mean = estimate(means);
            EXPECT_LT(std::abs(mean.mean - truly), 3 * both * mean.error) << "quarter " << first / quarter;
        }
        // Texel by texel, too: chance leaves a root mean square of 1, and three in a thousand beyond 3.
        double squares = 0, beyond = 0;
        for (const size_t i : texels_) {
            std::vector<double> values;
            for (const auto& bake : bakes)
                values.push_back(bake[i]);
            const Estimate light = estimate(values);
            const double off = (light.mean - truth_[i]) / (both * light.error);
            squares += off * off;
            beyond += std::abs(off) > 3;
        }
        const double count = static_cast<double>(texels_.size());
        EXPECT_LT(std::sqrt(squares / count), 1.15);
        EXPECT_LT(beyond / count, 0.01);
    }

    static inline std::vector<double> truth_;  // light of the room's texels
    static inline std::vector<size_t> texels_; // covered ones, the darkest first
};

TEST_F(Seeds, UniformSamplesDoNotSelect) {
    expectTruth(untilClean(false, false));
}

TEST_F(Seeds, SamplesOfChunksDoNotSelect) {
    expectTruth(untilClean(true, false));
}

TEST_F(Seeds, LayersDoNotSelect) {
    expectTruth(untilClean(false, true));
}

} // namespace relume
