#include "app/bench/lamp_placement.h"

#include <gtest/gtest.h>

#include "assets/base/error.h"
#include "tests/unit/trace_world.h"

namespace relume {
namespace {

const glm::vec3 kLow(-1, 0, -2), kHigh(3, 2, 1), kBlock(1, 1, -0.5f);
constexpr float kBlockRadius = 0.6f;

// Adds a ball seen from outside.
void addBall(TraceWorld& world, const glm::vec3& centre, float radius) {
    world.add(
        [=](float u, float v) {
            const float phi = u < 1 ? 6.28318531f * u : 0.0f, theta = 3.14159265f * v;
            return centre + radius * glm::vec3(std::sin(theta) * std::cos(phi), std::cos(theta),
                                               std::sin(theta) * std::sin(phi));
        },
        24);
}

TraceScene roomWithABlock() {
    TraceWorld world;
    world.addRoom(kLow, kHigh, 4);
    addBall(world, kBlock, kBlockRadius);
    return world.build();
}

void expectFree(const glm::vec3& p, float clearance) {
    for (int k = 0; k < 3; ++k) {
        EXPECT_GT(p[k], kLow[k] + 0.5f * clearance);
        EXPECT_LT(p[k], kHigh[k] - 0.5f * clearance);
    }
    EXPECT_GT(glm::distance(p, kBlock), 0.95f * kBlockRadius); // it is a little smaller: made of triangles
}

TEST(LampPlacement, LampsHangFreelyInTheRoom) {
    const TraceScene scene = roomWithABlock();
    const LampPlaces places = placeLamps(scene, 32);
    ASSERT_EQ(places.positions.size(), 32u);
    EXPECT_FLOAT_EQ(places.diagonal, glm::distance(kLow, kHigh));
    for (size_t i = 0; i < places.positions.size(); ++i) {
        expectFree(places.positions[i], 0.02f * places.diagonal);
        for (size_t j = 0; j < i; ++j)
            EXPECT_GT(glm::distance(places.positions[i], places.positions[j]), 0.0f);
    }
    expectFree(places.moved, 0.02f * places.diagonal);
    const glm::vec3 way = places.moved - places.positions[0], middle = 0.5f * (kLow + kHigh);
    EXPECT_NEAR(glm::length(way), 0.1f * places.diagonal, 1e-5f);
    EXPECT_NEAR(glm::dot(glm::normalize(way), glm::normalize(middle - places.positions[0])), 1.0f, 1e-5f);
}

TEST(LampPlacement, MoreLampsLeaveTheFirstOnesWhereTheyAre) {
    const TraceScene scene = roomWithABlock();
    const LampPlaces few = placeLamps(scene, 1), many = placeLamps(scene, 16);
    EXPECT_EQ(few.positions[0], many.positions[0]);
    EXPECT_EQ(few.moved, many.moved);
}

TEST(LampPlacement, LightIsOneAtAQuarterOfTheDiagonal) {
    const LampPlaces places{.positions = {glm::vec3(1), glm::vec3(2, 3, 4)}, .moved = {}, .diagonal = 8};
    const Light lamp = lampAt(places, 1);
    EXPECT_EQ(lamp.type, LightType::Point);
    EXPECT_EQ(glm::vec3(lamp.transform[3]), glm::vec3(2, 3, 4));
    EXPECT_NEAR(lamp.intensity / (2.0f * 2.0f) / 3.14159265f, 1.0f, 1e-6f); // E / pi
    EXPECT_FLOAT_EQ(lamp.radius, 0.04f);
}

// Inside of a ball only backs are seen; from outside it takes up too little of the view except close by.
TEST(LampPlacement, TellsWhereThereIsNoPlace) {
    TraceWorld world;
    addBall(world, {0, 0, 0}, 1);
    const TraceScene scene = world.build();
    try {
        placeLamps(scene, 2000);
        FAIL() << "found places";
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("--lights"), std::string::npos);
    }
}

} // namespace
} // namespace relume
