// These bakes have one bounce from a mesh light of radiance 1 to a black receiver: the lighting is the form
// factor.
#include "tests/gpu/bake_scene.h"
#include "tests/unit/closed_forms.h"

#include <gtest/gtest.h>

namespace relume {
namespace {

constexpr double kOnePercent = 0.01;
constexpr uint32_t kTexels = 64; // to a side of a square

closed::Vec vec(glm::vec3 v) {
    return {v.x, v.y, v.z};
}

/// Describes a receiver, with its front along u x v.
struct Plate {
    glm::vec3 corner, u, v;
    TexelRect rect;

    glm::vec3 at(uint32_t column, uint32_t row) const {
        return corner + (float(column) + 0.5f) / float(rect.width) * u +
               (float(row) + 0.5f) / float(rect.height) * v;
    }
    closed::Vec normal() const { return closed::unit(vec(glm::cross(u, v))); }
};

/// Expects that each texel of `plate` is lit as the parallelogram says, to a share of its own value and of
/// the largest.
void expectLitBy(const FloatImage& lighting, const Plate& plate, glm::vec3 corner, glm::vec3 u, glm::vec3 v) {
    const double largest = statistics(lighting, plate.rect).max;
    for (uint32_t row = 0; row < plate.rect.height; ++row) {
        for (uint32_t column = 0; column < plate.rect.width; ++column) {
            const double exact = closed::integratedParallelogram(vec(plate.at(column, row)), plate.normal(),
                                                                 vec(corner), vec(u), vec(v), 1e-6);
            EXPECT_NEAR(texel(lighting, plate.rect, column, row), exact, 0.01 * exact + 0.001 * largest)
                << "texel " << column << ", " << row;
        }
    }
}

} // namespace

TEST(ViewFactor, ParallelSquares) {
    SceneMaker maker(2 * kTexels + 1);
    const TexelRect receiver = maker.quad({0, 0, 0}, kX, kY, maker.material(0.0f), glm::uvec2(kTexels));
    const TexelRect emitter = maker.quad({0, 0, 1}, kY, kX, maker.material(0.0f, 1.0f), glm::uvec2(kTexels));
    const Baked baked = bakeScene(maker.scene(), {.size = maker.size()});
    const double exact = closed::parallelRectangles(1, 1, 1);
    EXPECT_NEAR(exact, 0.19982, 1e-5);
    EXPECT_NEAR(statistics(baked.lighting, receiver).mean, exact, kOnePercent * exact);
    EXPECT_EQ(statistics(baked.lighting, receiver).count, kTexels * kTexels);
    EXPECT_EQ(statistics(baked.lighting, emitter).max, 0.0); // nothing shines on it
}

TEST(ViewFactor, PerpendicularSquares) {
    SceneMaker maker(2 * kTexels + 1);
    const TexelRect receiver = maker.quad({0, 0, 0}, kX, kY, maker.material(0.0f), glm::uvec2(kTexels));
    maker.quad({0, 0, 0}, kY, kZ, maker.material(0.0f, 1.0f), glm::uvec2(kTexels));
    const Baked baked = bakeScene(maker.scene(), {.size = maker.size()});
    const double exact = closed::perpendicularRectangles(1, 1, 1);
    EXPECT_NEAR(exact, 0.20004, 1e-5);
    EXPECT_NEAR(statistics(baked.lighting, receiver).mean, exact, kOnePercent * exact);
}

TEST(ViewFactor, CoaxialDiscs) {
    SceneMaker maker(2 * kTexels + 1);
    const TexelRect receiver = maker.disc({0, 0, 0}, kX, kY, maker.material(0.0f), kTexels);
    maker.disc({0, 0, 1}, kY, kX, maker.material(0.0f, 1.0f), kTexels);
    const Baked baked = bakeScene(maker.scene(), {.size = maker.size()});
    const double exact = closed::coaxialDiscs(1, 1, 1);
    EXPECT_NEAR(exact, 0.38197, 1e-5);
    EXPECT_NEAR(statistics(baked.lighting, receiver).mean, exact, kOnePercent * exact);
}

TEST(ViewFactor, PointAndDisc) {
    for (const float height : {0.2f, 1.0f, 5.0f}) {
        SceneMaker maker(64);
        const TexelRect receiver =
            maker.quad({-1e-3f, -1e-3f, 0}, 2e-3f * kX, 2e-3f * kY, maker.material(0.0f), glm::uvec2(2));
        maker.disc({0, 0, height}, kY, kX, maker.material(0.0f, 1.0f), 48);
        const Baked baked = bakeScene(maker.scene(), {.size = maker.size()});
        const double exact = closed::pointToDisc(1, height);
        EXPECT_NEAR(statistics(baked.lighting, receiver).mean, exact, kOnePercent * exact) << height;
    }
}

// These are the catalogue's B-3 and B-4: the corner of the rectangle is above the plate, at its foot.
TEST(ViewFactor, PointAndRectangle) {
    constexpr float kSmall = 1e-3f;
    SceneMaker parallel(64);
    TexelRect receiver = parallel.quad(-kSmall * (kX + kY), 2 * kSmall * kX, 2 * kSmall * kY,
                                       parallel.material(0.0f), glm::uvec2(2));
    parallel.quad({0, 0, 0.7f}, 1.3f * kY, 0.8f * kX, parallel.material(0.0f, 1.0f), glm::uvec2(48));
    double exact = closed::pointToParallelRectangle(1.3, 0.8, 0.7);
    EXPECT_NEAR(statistics(bakeScene(parallel.scene(), {.size = 64}).lighting, receiver).mean, exact,
                kOnePercent * exact);

    SceneMaker perpendicular(64);
    receiver = perpendicular.quad(-kSmall * (kX + kY), 2 * kSmall * kX, 2 * kSmall * kY,
                                  perpendicular.material(0.0f), glm::uvec2(2));
    // This lies in the plane x = -0.4 and faces the plate, which looks along z.
    perpendicular.quad({-0.4f, 0, 0}, 0.9f * kY, 1.1f * kZ, perpendicular.material(0.0f, 1.0f),
                       glm::uvec2(48));
    exact = closed::pointToPerpendicularRectangle(1.1, 0.9, 0.4);
    EXPECT_NEAR(statistics(bakeScene(perpendicular.scene(), {.size = 64}).lighting, receiver).mean, exact,
                kOnePercent * exact);
}

TEST(ViewFactor, OffsetEmitter) {
    const glm::vec3 corner(1.1f, -0.2f, 0.35f), u = 0.9f * kY, v = 0.6f * kX;
    SceneMaker maker(64);
    Plate plate{{0, 0, 0}, kX, kY, {}};
    plate.rect = maker.quad(plate.corner, plate.u, plate.v, maker.material(0.0f), glm::uvec2(16));
    maker.quad(corner, u, v, maker.material(0.0f, 1.0f), glm::uvec2(32));
    expectLitBy(bakeScene(maker.scene(), {.size = maker.size()}).lighting, plate, corner, u, v);
}

// The mesh light leans, is near, and is partly below the receivers' horizon.
TEST(ViewFactor, LeaningEmitterCutByTheHorizon) {
    const glm::vec3 corner(-0.3f, 0.0f, -0.5f), u = kY, v = glm::vec3(-0.3f, 0.1f, 1.2f);
    SceneMaker maker(96);
    Plate plate{{0, 0, 0}, kX, kY, {}};
    plate.rect = maker.quad(plate.corner, plate.u, plate.v, maker.material(0.0f), glm::uvec2(16));
    maker.quad(corner, u, v, maker.material(0.0f, 1.0f), glm::uvec2(64));
    expectLitBy(bakeScene(maker.scene(), {.size = maker.size()}).lighting, plate, corner, u, v);
}

// A half plane hides the mesh light up to a line that moves as the receiver does. The centres of its texels
// decide which columns are seen: the error of one texel is half a column, that of the mean is next to none.
TEST(ViewFactor, HalfHiddenBigNearEmitter) {
    constexpr uint32_t kColumns = 64;
    constexpr float kHeight = 0.5f, kEdgeHeight = 0.25f, kHalf = 1.0f;
    SceneMaker maker(2 * kColumns);
    Plate plate{{-0.4f, -0.4f, 0}, 0.8f * kX, 0.8f * kY, {}};
    plate.rect = maker.quad(plate.corner, plate.u, plate.v, maker.material(0.0f), glm::uvec2(24));
    maker.quad({-kHalf, kHalf, kHeight}, 2 * kHalf * kX, -2 * kHalf * kY, maker.material(0.0f, 1.0f),
               glm::uvec2(kColumns));
    Material board; // double-sided: who sees a single-sided back counts as shut in
    board.doubleSided = true;
    maker.blocker({-4, -4, kEdgeHeight}, 4.0f * kX, 8.0f * kY, maker.material(board));
    const FloatImage lighting = bakeScene(maker.scene(), {.size = maker.size()}).lighting;
    const double column = 2.0 * kHalf / kColumns;
    double sum = 0, exactSum = 0;
    for (uint32_t row = 0; row < plate.rect.height; ++row) {
        for (uint32_t c = 0; c < plate.rect.width; ++c) {
            const glm::vec3 p = plate.at(c, row);
            const double from =
                p.x - p.x * kHeight / kEdgeHeight; // where the line over the edge at x = 0 ends
            const auto strip = [&](double x, double width) {
                return closed::integratedParallelogram(vec(p), plate.normal(), {x, kHalf, kHeight},
                                                       {width, 0, 0}, {0, -2 * kHalf, 0}, 1e-6);
            };
            const double exact = strip(from, kHalf - from);
            const double value = texel(lighting, plate.rect, c, row);
            EXPECT_NEAR(value, exact, 0.51 * strip(from, column) + 0.005 * exact) << c << ", " << row;
            sum += value;
            exactSum += exact;
        }
    }
    EXPECT_NEAR(sum, exactSum, kOnePercent * exactSum);
}

// F_ij A_i = F_ji A_j is the power that reaches j from i, and the other way round.
TEST(ViewFactor, Reciprocity) {
    const auto power = [](bool firstEmits) {
        SceneMaker maker(96);
        const int black = maker.material(0.0f), lamp = maker.material(0.0f, 1.0f);
        const TexelRect first =
            maker.quad({0, 0, 0}, 1.7f * kX, 0.6f * kY, firstEmits ? lamp : black, {51, 18});
        const TexelRect second =
            maker.quad({0.9f, -0.4f, 0.5f}, glm::vec3(0.0f, 0.4f, 0.05f), glm::vec3(0.35f, 0.0f, -0.1f),
                       firstEmits ? black : lamp, {12, 11});
        const Baked baked = bakeScene(maker.scene(), {.size = maker.size()});
        const double area =
            firstEmits ? glm::length(glm::cross(glm::vec3(0.0f, 0.4f, 0.05f), glm::vec3(0.35f, 0.0f, -0.1f)))
                       : 1.7 * 0.6;
        return statistics(baked.lighting, firstEmits ? second : first).mean * area;
    };
    const double there = power(true), back = power(false);
    EXPECT_GT(there, 0.01);
    EXPECT_NEAR(there, back, 0.005 * there);
}

} // namespace relume
