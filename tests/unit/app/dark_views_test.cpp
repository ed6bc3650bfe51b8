// Cameras that look at dark places are held against a room of which one end is dark.
#include "app/bench/quality/dark_views.h"

#include "tests/unit/shapes.h"

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

namespace relume {
namespace {

// Makes a room from the origin to this corner, whose faces look inwards.
WorldMesh roomOf(const glm::vec3& size) {
    Primitive box = test::cube();
    for (size_t i = 0; i < box.indices.size(); i += 3)
        std::swap(box.indices[i + 1], box.indices[i + 2]);
    Scene scene;
    scene.path = "room.glb";
    test::addInstance(scene, test::addMesh(scene, std::move(box)), glm::scale(glm::mat4(1.0f), size));
    LightmapAtlas none;
    none.instances.resize(1);
    return flatten(scene, none);
}

// Covers the floor by 20 x 20 points; where x is below an eighth of the room they are dark.
std::vector<LitPoint> floorOf(const glm::vec3& size) {
    std::vector<LitPoint> points;
    for (int i = 0; i < 400; ++i) {
        const glm::vec3 place(static_cast<float>(i % 20) + 0.5f, 0.0f, static_cast<float>(i / 20) + 0.5f);
        points.push_back({.position = place / 20.0f * glm::vec3(size.x, 0, size.z),
                          .normal = {0, 1, 0},
                          .area = size.x * size.z / 400.0f,
                          .light = i % 20 < 5 ? 0.1f : 1.0f});
    }
    return points;
}

TEST(DarkViews, StandInTheDarkAndLookAlongTheLongestWay) {
    // A picture of 60 degrees shows a level floor from 2.8 m on, so the dark quarter must be longer than
    // that.
    const glm::vec3 size(16, 3, 2);
    const LevelRays rays(roomOf(size));
    const std::vector<LitPoint> floor = floorOf(size);
    const std::vector<ViewCamera> views = darkViews(rays, floor, 2);
    ASSERT_FALSE(views.empty());
    for (const ViewCamera& view : views) {
        EXPECT_FLOAT_EQ(view.eye.y, 1.6f);
        EXPECT_LT(view.eye.x, 4.0f); // a quarter of the floor is dark
        EXPECT_GT(forward(view).x, 0.9f);
        EXPECT_NEAR(forward(view).y, 0.0f, 1e-6f);
    }
    EXPECT_EQ(darkViews(rays, floor, 2)[0], views[0]);
}

TEST(DarkViews, EyesAreLowerWhereNobodyCanStand) {
    const glm::vec3 size(4, 1, 1);
    const std::vector<ViewCamera> views = darkViews(LevelRays(roomOf(size)), floorOf(size), 1);
    ASSERT_EQ(views.size(), 1u);
    EXPECT_NEAR(views[0].eye.y, 0.5f, 0.01f);
}

TEST(DarkViews, ThereAreNoneOfBlackness) {
    const glm::vec3 size(8, 3, 2);
    std::vector<LitPoint> black = floorOf(size);
    for (LitPoint& point : black)
        point.light = 0;
    EXPECT_TRUE(darkViews(LevelRays(roomOf(size)), black, 3).empty());
    EXPECT_TRUE(darkViews(LevelRays(roomOf(size)), {}, 3).empty());
}

} // namespace
} // namespace relume
