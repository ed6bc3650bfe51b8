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
    EXPECT_EQ(shader::rotationKey(a, first, shader::kRotateInterleaved, size), 1u * 4 + 2);
    EXPECT_EQ(shader::rotationKey(b, first, shader::kRotateInterleaved, size), 1u * 4 + 2);
    EXPECT_EQ(shader::rotationKey(a, first, shader::kRotatePatch, size), 9 * size + 6);
    EXPECT_EQ(shader::rotationKey(a, first, shader::kRotateTile, size), 5u);
}

} // namespace
} // namespace relume
