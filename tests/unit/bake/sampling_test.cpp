#include <array>
#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "bake/base/shader_types.h"
#include "bake/links/directions.h"

namespace relume {
namespace {

using shader::Patch;

// Any 2^m consecutive points from 0 on put one point in each elementary interval of area 2^-m: a (0, m,
// 2)-net.
TEST(Sampling, sobolPointsAreStratifiedHoweverScrambled) {
    constexpr uint32_t m = 6, count = 1u << m;
    for (uint32_t seed : {0u, 1u, 77u, 0xdeadbeefu}) {
        for (uint32_t xBits = 0; xBits <= m; ++xBits) {
            std::set<uint32_t> cells;
            for (uint32_t i = 0; i < count; ++i) {
                const glm::vec2 p = shader::sobolPoint(i, seed);
                const uint32_t x = uint32_t(p.x * float(1u << xBits)),
                               y = uint32_t(p.y * float(1u << (m - xBits)));
                cells.insert(x << m | y);
            }
            EXPECT_EQ(cells.size(), count) << "seed " << seed << ", " << (1 << xBits) << " columns";
        }
    }
}

TEST(Sampling, sobolPointsLieInTheUnitSquareAndDependOnTheSeed) {
    uint32_t equal = 0;
    for (uint32_t i = 0; i < 4096; ++i) {
        const glm::vec2 p = shader::sobolPoint(i, 5), q = shader::sobolPoint(i, 6);
        EXPECT_TRUE(p.x >= 0 && p.y >= 0 && p.x < 1 && p.y < 1);
        equal += p == q;
    }
    EXPECT_LT(equal, 4u);
}

TEST(Sampling, meanOfManyScramblesIsTheIntegral) {
    double sum = 0;
    for (uint32_t seed = 0; seed < 256; ++seed) {
        for (uint32_t i = 0; i < 16; ++i) {
            const glm::vec2 p = shader::sobolPoint(i, shader::hash32(seed));
            sum += double(p.x) * p.x * p.y;
        }
    }
    EXPECT_NEAR(sum / (256 * 16), 1.0 / 6.0, 1e-3);
}

namespace {

// Returns the points that samples 0 to `count` - 1 of one replicate have, of each texel of a block.
std::vector<std::vector<glm::vec2>> pointsOfBlock(glm::uvec2 block, uint32_t size, uint32_t count) {
    std::vector<std::vector<glm::vec2>> points;
    for (uint32_t y = 0; y < shader::kBlockEdge; ++y) {
        for (uint32_t x = 0; x < shader::kBlockEdge; ++x) {
            const glm::uvec2 texel = block * shader::kBlockEdge + glm::uvec2(x, y);
            const uint32_t key = shader::blockKey(texel.y * size + texel.x, size);
            points.emplace_back();
            for (uint32_t i = 0; i < count; ++i)
                points.back().push_back(shader::directionPoint(key, i * shader::kReplicates));
        }
    }
    return points;
}

// Tells whether all elementary intervals of 2^-bits have as many points.
bool areEven(const std::vector<glm::vec2>& points, uint32_t bits) {
    for (uint32_t xBits = 0; xBits <= bits; ++xBits) {
        std::vector<size_t> found(size_t{1} << bits);
        for (const glm::vec2& p : points)
            ++found[uint32_t(p.x * float(1u << xBits)) << (bits - xBits) |
                    uint32_t(p.y * float(1u << (bits - xBits)))];
        for (const size_t count : found)
            if (count << bits != points.size()) return false;
    }
    return true;
}

double inDisc(glm::vec2 p) {
    return glm::distance(p, {0.4f, 0.3f}) < 0.45f ? 1.0 : 0.0;
}

} // namespace

// A texel's own points are a (0, m, 2)-net as without a block; those of 2 x 2 and of 4 x 4 texels are (2, m,
// 2)-nets.
TEST(Sampling, PointsOfTexelsAreEvenAloneAndTogether) {
    constexpr uint32_t size = 64, worst = 2; // worst: the t of the nets
    for (const glm::uvec2 block : {glm::uvec2(0, 0), glm::uvec2(3, 7), glm::uvec2(15, 15)}) {
        for (uint32_t m = 2; m <= 9; ++m) {
            const auto points = pointsOfBlock(block, size, 1u << m);
            std::vector<glm::vec2> all, quarter;
            for (uint32_t i = 0; i < points.size(); ++i) {
                EXPECT_TRUE(areEven(points[i], m)) << "texel " << i << ", 2^" << m << " points";
                all.insert(all.end(), points[i].begin(), points[i].end());
                const bool near = i % shader::kBlockEdge < 2 && i / shader::kBlockEdge < 2;
                if (near) quarter.insert(quarter.end(), points[i].begin(), points[i].end());
            }
            EXPECT_TRUE(areEven(quarter, m + 2 - worst)) << "2^" << m << " points";
            EXPECT_TRUE(areEven(all, m + 4 - worst)) << "2^" << m << " points";
        }
    }
}

TEST(Sampling, KeysTellTexelsApart) {
    for (const uint32_t size : {8u, 37u, 64u}) { // 37 has blocks that are cut off
        std::set<uint32_t> keys, seeds;
        for (uint32_t texel = 0; texel < size * size; ++texel) {
            keys.insert(shader::blockKey(texel, size));
            seeds.insert(shader::directionSeed(shader::blockKey(texel, size), 0));
        }
        const uint32_t blocks = (size + shader::kBlockEdge - 1) / shader::kBlockEdge;
        EXPECT_EQ(keys.size(), size * size);
        EXPECT_EQ(seeds.size(), blocks * blocks);
    }
}

// The mean of a block of what is seen through an edge has half of the standard error that sixteen texels with
// scramblings of their own have together, and single texels have as much as ever.
TEST(Sampling, MeansOfBlocksAreLessNoisy) {
    constexpr uint32_t size = 256, count = 16;
    const double exact = [] {
        double sum = 0;
        constexpr uint32_t fine = 1024;
        for (uint32_t i = 0; i < fine * fine; ++i)
            sum += inDisc((glm::vec2(i % fine, i / fine) + 0.5f) / float(fine));
        return sum / (fine * fine);
    }();
    double ofBlocks = 0, ofTexels = 0;
    uint32_t blocks = 0;
    for (uint32_t y = 0; y < size / shader::kBlockEdge; ++y) {
        for (uint32_t x = 0; x < size / shader::kBlockEdge; ++x, ++blocks) {
            double block = 0;
            for (const std::vector<glm::vec2>& points : pointsOfBlock({x, y}, size, count)) {
                double texel = 0;
                for (const glm::vec2& p : points)
                    texel += inDisc(p) / count;
                block += texel / 16;
                ofTexels += (texel - exact) * (texel - exact) / 16;
            }
            ofBlocks += (block - exact) * (block - exact);
        }
    }
    EXPECT_LT(std::sqrt(ofBlocks), 0.6 * std::sqrt(ofTexels / 16));
    double alone = 0;
    for (uint32_t key = 0; key < 16 * blocks; ++key) {
        double texel = 0;
        for (uint32_t i = 0; i < count; ++i)
            texel += inDisc(shader::directionPoint(shader::keyAlone(key), i * shader::kReplicates)) / count;
        alone += (texel - exact) * (texel - exact) / 16;
    }
    EXPECT_NEAR(std::sqrt(ofTexels), std::sqrt(alone), 0.1 * std::sqrt(alone));
}

// With density cos / pi, the mean cosine is 2/3 and the mean of x^2 is 1/4.
TEST(Sampling, cosineDirectionsHaveTheRightMoments) {
    double cosine = 0, x2 = 0, x = 0;
    constexpr uint32_t count = 4096;
    for (uint32_t i = 0; i < count; ++i) {
        const glm::vec3 d = shader::cosineDirection(shader::sobolPoint(i, 3));
        EXPECT_NEAR(glm::length(d), 1.0f, 1e-6f);
        EXPECT_GE(d.z, 0.0f);
        cosine += d.z, x2 += d.x * d.x, x += d.x;
    }
    EXPECT_NEAR(cosine / count, 2.0 / 3.0, 1e-3);
    EXPECT_NEAR(x2 / count, 0.25, 1e-3);
    EXPECT_NEAR(x / count, 0.0, 1e-3);
}

TEST(Sampling, cosineDirectionHandlesTheSquaresCentreAndCorners) {
    EXPECT_EQ(shader::cosineDirection({0.5f, 0.5f}), glm::vec3(0, 0, 1));
    for (float u : {0.0f, 0.99999994f})
        for (float v : {0.0f, 0.99999994f}) {
            const glm::vec3 d = shader::cosineDirection({u, v});
            EXPECT_NEAR(glm::length(d), 1.0f, 1e-6f);
            EXPECT_NEAR(d.z, 0.0f, 1e-3f);
        }
}

TEST(Sampling, aroundNormalIsARotation) {
    const glm::vec3 normals[] = {{0, 0, 1},  {0, 0, -1},
                                 {1, 0, 0},  glm::normalize(glm::vec3(1e-4f, 0, -1)),
                                 {0, -1, 0}, glm::normalize(glm::vec3(1, 2, -3))};
    for (const glm::vec3& n : normals) {
        const glm::vec3 x = shader::aroundNormal(n, {1, 0, 0}), y = shader::aroundNormal(n, {0, 1, 0});
        EXPECT_EQ(shader::aroundNormal(n, {0, 0, 1}), n);
        EXPECT_NEAR(glm::length(x), 1.0f, 1e-5f);
        EXPECT_NEAR(glm::length(y), 1.0f, 1e-5f);
        EXPECT_NEAR(glm::dot(x, y), 0.0f, 1e-5f);
        EXPECT_NEAR(glm::dot(x, n), 0.0f, 1e-5f);
        EXPECT_NEAR(glm::dot(glm::cross(x, y), n), 1.0f, 1e-5f) << "mirrored";
    }
}

TEST(Sampling, patchDirectionStaysAboveTheGeometricHorizon) {
    Patch patch{};
    patch.normal = {0, 0, 1};
    for (float tilt : {0.0f, 0.5f, 1.2f, 1.57f}) {
        patch.shading = {std::sin(tilt), 0, std::cos(tilt)};
        uint32_t mirrored = 0;
        for (uint32_t i = 0; i < 1024; ++i) {
            const glm::vec3 d = shader::patchDirection(patch, 9, i);
            EXPECT_GE(glm::dot(d, patch.normal), 0.0f);
            EXPECT_NEAR(glm::length(d), 1.0f, 1e-5f);
            mirrored += glm::dot(d, patch.shading) < 0;
        }
        if (tilt == 0.0f) {
            EXPECT_EQ(mirrored, 0u);
        }
    }
}

// Whatever the set, each point's mean over all patches is that of the cosine's density; sets as a whole are
// even for each patch.
TEST(Sampling, discDirectionsAreCosineDistributed) {
    const std::vector<glm::dvec2> set = evenRings(largestEmptyCircleDisc(64));
    constexpr uint32_t patches = 4000;
    for (const uint32_t k : {0u, 1u, 40u}) { // one point, its ring around the middle r^2 of it
        double x = 0, r2 = 0;
        for (uint32_t key = 0; key < patches; ++key) {
            const glm::vec3 d = shader::discDirection(set[k], 64, shader::hash32(key));
            EXPECT_NEAR(glm::length(d), 1.0f, 1e-6f);
            x += d.x / patches, r2 += (1 - d.z * d.z) / patches;
        }
        EXPECT_NEAR(x, 0, 0.04);
        EXPECT_NEAR(r2, glm::dot(set[k], set[k]), 2e-3);
    }
    double worst = 0, mean = 0;
    for (uint32_t key = 0; key < 200; ++key) {
        double z = 0;
        for (const glm::dvec2& p : set)
            z += shader::discDirection(p, 64, shader::hash32(key)).z / 64;
        worst = std::max(worst, std::abs(z - 2.0 / 3));
        mean += z / 200;
    }
    EXPECT_LT(worst, 0.01); // 64 random directions: 0.1
    EXPECT_NEAR(mean, 2.0 / 3, 1e-3);
}

// Any one sample may be any point of the set, and a replicate's samples are each point once.
TEST(Sampling, discSetsBeginAnywhereAndAreUsedWhole) {
    constexpr uint32_t count = 12;
    std::array<uint32_t, count> firsts{};
    for (uint32_t key = 0; key < 1200; ++key) {
        std::set<uint32_t> round;
        for (uint32_t index = 1; index < count * shader::kReplicates; index += shader::kReplicates) {
            const uint32_t point = shader::discPoint(index, count, shader::discSeed(key, index, count));
            if (index == 1) ++firsts[point];
            round.insert(point);
        }
        EXPECT_EQ(round.size(), count);
    }
    for (uint32_t n : firsts)
        EXPECT_NEAR(n, 100, 40);
}

TEST(Sampling, turnsAreUnitVectorsAllAround) {
    double x = 0, y = 0;
    for (uint32_t i = 0; i < 64; ++i) {
        const glm::vec2 t = shader::turnBy(i << 26);
        EXPECT_NEAR(glm::length(t), 1.0f, 1e-6f);
        const glm::vec2 next = shader::turnBy((i + 1) << 26);
        EXPECT_NEAR(t.x * next.y - t.y * next.x, std::sin(6.2831853 / 64), 1e-6);
        x += t.x, y += t.y;
    }
    EXPECT_NEAR(x, 0, 1e-5);
    EXPECT_NEAR(y, 0, 1e-5);
}

TEST(Sampling, interleavedPatchesShareTheirKeys) {
    Patch first{}, a{}, b{};
    constexpr uint32_t size = 128;
    first.flags = 5 << shader::kTexelShift;
    a.flags = (9 * size + 6) << shader::kTexelShift; // row 9, column 6
    b.flags = (13 * size + 2) << shader::kTexelShift;
    EXPECT_EQ(shader::rotationKey(a, first, shader::kRotateInterleaved, size), shader::keyAlone(1 * 4 + 2));
    EXPECT_EQ(shader::rotationKey(b, first, shader::kRotateInterleaved, size), shader::keyAlone(1 * 4 + 2));
    EXPECT_EQ(shader::rotationKey(a, first, shader::kRotatePatch, size),
              shader::blockKey(9 * size + 6, size));
    EXPECT_EQ(shader::rotationKey(a, first, shader::kRotateAlone, size), shader::keyAlone(9 * size + 6));
    EXPECT_EQ(shader::rotationKey(a, first, shader::kRotateTile, size), shader::keyAlone(5));
}

} // namespace
} // namespace relume
