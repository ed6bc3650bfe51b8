// The light of a source of which some points are seen, against integrals in closed form.
#include "bake/base/shader_types.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

namespace relume {
namespace {

using shader::kReplicates;

// Sums over the points of one sample pass.
struct Points {
    std::array<float, kReplicates> part{}, seen{};
    float all = 0, visible = 0;

    void add(uint32_t replicate, float factor, bool isSeen) {
        part[replicate] += factor;
        all += factor;
        if (!isSeen) return;
        seen[replicate] += factor;
        visible += factor;
    }
    float light(uint32_t replicate, float whole, float count) const {
        return shader::seenLight(whole, count, part[replicate], seen[replicate], all, visible);
    }
};

struct Estimates {
    double mean = 0, standardError = 0;
    double ratio = 0; // the mean of what all points together say is seen
};

// Of a source along x in [0, 1] whose point brings 2 x and is seen beyond `edge`, from one point for each
// replicate: whole 1, seen 1 - edge^2.
Estimates estimate(float edge, uint32_t passes) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> unit(0, 1);
    double sum = 0, squares = 0, ratios = 0;
    for (uint32_t k = 0; k < passes; ++k) {
        Points points;
        for (uint32_t q = 0; q < kReplicates; ++q) {
            const float x = unit(random);
            points.add(q, 2.0f * x, x > edge);
        }
        double mean = 0;
        for (uint32_t q = 0; q < kReplicates; ++q)
            mean += points.light(q, 1.0f, 1.0f) / kReplicates;
        sum += mean;
        squares += mean * mean;
        ratios += points.visible / points.all;
    }
    const double mean = sum / passes;
    return {mean, std::sqrt((squares / passes - mean * mean) / passes), ratios / passes};
}

TEST(SeenLight, IsExactInTheMeanForFewPoints) {
    for (const float edge : {0.3f, 0.7f, 0.95f}) {
        const Estimates e = estimate(edge, 400000);
        const double exact = 1.0 - double{edge} * edge;
        EXPECT_NEAR(e.mean, exact, 3.0 * e.standardError) << edge;
        EXPECT_GT(std::abs(e.ratio - exact), 10.0 * e.standardError) << "a ratio of sums is off";
    }
}

TEST(SeenLight, SeenAsAWholeOrNotAtAllIsExact) {
    Points seen, hidden;
    for (uint32_t q = 0; q < kReplicates; ++q)
        for (uint32_t k = 0; k < 3; ++k) {
            const float factor = 0.1f + 0.37f * static_cast<float>(q) + 0.21f * static_cast<float>(k);
            seen.add(q, factor, true);
            hidden.add(q, factor, false);
        }
    for (uint32_t q = 0; q < kReplicates; ++q) {
        EXPECT_EQ(seen.light(q, 0.7f, 3.0f), 0.7f);
        EXPECT_EQ(hidden.light(q, 0.7f, 3.0f), 0.0f);
    }
}

// Below the horizon points bring nothing, and may be all that a sample pass has.
TEST(SeenLight, IsFiniteWithoutOtherPoints) {
    Points none, one;
    one.add(2, 0.8f, true);
    for (uint32_t q = 0; q < kReplicates; ++q)
        EXPECT_EQ(none.light(q, 0.5f, 1.0f), 0.0f);
    EXPECT_EQ(one.light(2, 0.5f, 1.0f), 0.8f); // its own points alone
    EXPECT_EQ(one.light(0, 0.5f, 1.0f), 0.5f);
}

// A red source lies along x in [0, 1] and brings (1, 0), of which 0.6 is seen; a green one beside it brings
// (0, 0.5), of which 0.4 is seen. Picks take them with chances that are not what each brings.
TEST(SeenLight, PicksAreExactInTheMean) {
    const glm::vec3 whole(1.0f, 0.5f, 0.0f);
    std::mt19937 random(4);
    std::uniform_real_distribution<float> unit(0, 1);
    constexpr uint32_t kPasses = 200000;
    glm::dvec3 sum(0.0), squares(0.0);
    for (uint32_t k = 0; k < kPasses; ++k) {
        std::array<glm::vec3, kReplicates> part{}, seen{};
        glm::vec3 all(0.0f), visible(0.0f);
        for (uint32_t q = 0; q < kReplicates; ++q) {
            const bool red = unit(random) < 0.3f;
            const float x = unit(random);
            const glm::vec3 light = red ? glm::vec3(1.0f / 0.3f, 0, 0) : glm::vec3(0, 0.5f / 0.7f, 0);
            part[q] = light;
            all += light;
            if (red ? x < 0.4f : x < 0.6f) continue;
            seen[q] = light;
            visible += light;
        }
        glm::dvec3 mean(0.0);
        for (uint32_t q = 0; q < kReplicates; ++q)
            mean += glm::dvec3(shader::seenPicks(whole, 1.0f, part[q], seen[q], all, visible)) /
                    double(kReplicates);
        sum += mean;
        squares += mean * mean;
    }
    const glm::dvec3 mean = sum / double(kPasses);
    const glm::dvec3 error = glm::sqrt((squares / double(kPasses) - mean * mean) / double(kPasses));
    EXPECT_NEAR(mean.r, 0.6, 3.0 * error.r);
    EXPECT_NEAR(mean.g, 0.2, 3.0 * error.g);
    EXPECT_EQ(mean.b, 0.0);
}

TEST(SeenLight, PicksOfASourceSeenAsAWholeOrNotAtAllAreExact) {
    const glm::vec3 whole(0.3f, 0.7f, 0.2f), part(0.9f, 0.1f, 0.4f), all(3.1f, 1.2f, 0.7f), none(0.0f);
    EXPECT_EQ(shader::seenPicks(whole, 2.0f, part, part, all, all), whole);
    EXPECT_EQ(shader::seenPicks(whole, 2.0f, part, none, all, none), none);
    EXPECT_EQ(shader::seenPicks(whole, 2.0f, part, part, part, part), 0.5f * part) << "its own picks alone";
}

} // namespace
} // namespace relume
