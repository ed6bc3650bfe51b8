// These tests ask where somebody would stand in levels of which one knows what they are.
#include "assets/survey/street_view.h"

#include "assets/survey/level_ground.h"
#include "tests/unit/shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include <glm/gtc/matrix_transform.hpp>

namespace relume {
namespace {

constexpr float kAspect = 16.0f / 9.0f;

/// A level of boxes and grounds, with what looks around in it.
class Level {
public:
    void addBox(const glm::vec3& low, const glm::vec3& high) {
        const glm::mat4 place = glm::translate(glm::mat4(1.0f), low);
        test::addInstance(scene_, test::addMesh(scene_, test::cube()), glm::scale(place, high - low));
    }
    /// Adds the ground of a height [m] at each x and z, over `edge` metres about the origin.
    template<typename Height>
    void addGround(float edge, const Height& height, bool turned = false) {
        constexpr uint32_t kAlong = 64;
        std::vector<glm::vec3> positions;
        std::vector<uint32_t> indices;
        for (uint32_t i = 0; i <= kAlong; ++i)
            for (uint32_t j = 0; j <= kAlong; ++j) {
                const float x = edge * (static_cast<float>(i) / kAlong - 0.5f);
                const float z = edge * (static_cast<float>(j) / kAlong - 0.5f);
                positions.emplace_back(x, height(x, z), z);
            }
        for (uint32_t i = 0; i < kAlong; ++i)
            for (uint32_t j = 0; j < kAlong; ++j) {
                const uint32_t a = i * (kAlong + 1) + j, b = a + 1, c = a + kAlong + 1, d = c + 1;
                indices.insert(indices.end(), {a, b, d, a, d, c});
            }
        if (turned)
            for (size_t i = 0; i < indices.size(); i += 3)
                std::swap(indices[i + 1], indices[i + 2]);
        test::addInstance(scene_, test::addMesh(scene_, test::primitiveOf(positions, indices)));
    }
    void addPlane(float edge) {
        addGround(edge, [](float, float) { return 0.0f; });
    }
    /// Adds two rows of houses, 8 m high, along a street of 60 x 10 m.
    void addStreet() {
        for (float x = -30.0f; x < 30.0f; x += 10.0f)
            for (const float z : {-15.0f, 5.0f})
                addBox({x, 0, z}, {x + 8, 8, z + 10});
    }

    std::optional<StandingView> view() {
        look();
        return standingView(*rays_, low_, high_, kAspect);
    }
    LevelGround ground() {
        look();
        return findGround(*rays_, low_, high_);
    }
    const LevelRays& rays() const { return *rays_; }

private:
    void look() {
        scene_.path = "level.glb";
        LightmapAtlas none;
        none.instances.resize(scene_.instances.size());
        const WorldMesh mesh = flatten(scene_, none);
        low_ = high_ = mesh.positions.front();
        for (const glm::vec3& point : mesh.positions) {
            low_ = glm::min(low_, point);
            high_ = glm::max(high_, point);
        }
        rays_.emplace(mesh);
    }
    Scene scene_;
    glm::vec3 low_{0.0f}, high_{0.0f};
    std::optional<LevelRays> rays_;
};

TEST(StandingView, IsOnTheGroundOfAStreetAndLooksAlongIt) {
    Level level;
    level.addPlane(64);
    level.addStreet();
    const std::optional<StandingView> view = level.view();
    ASSERT_TRUE(view);
    EXPECT_NEAR(view->eye.y, 1.7f, 1e-3f);
    EXPECT_LT(std::abs(view->eye.x), 32) << "it is in the street";
    EXPECT_LT(std::abs(view->eye.z), 4.5f) << "no wall is before the eye";
    const glm::vec3 way = glm::normalize(view->target - view->eye);
    EXPECT_GT(std::abs(way.x), 0.7f) << "along the street, not at a wall";
    EXPECT_GT(30 - std::copysign(1.0f, way.x) * view->eye.x, 20.0f) << "and most of it is ahead";
}

TEST(StandingView, FollowsTheGroundOfAStreetThatClimbs) {
    const auto slope = [](float x, float) { return 0.1f * x; };
    Level level;
    level.addGround(64, slope);
    for (float x = -30.0f; x < 30.0f; x += 10.0f)
        for (const float z : {-15.0f, 5.0f})
            level.addBox({x, 0.1f * x - 2, z}, {x + 9.5f, 0.1f * x + 9, z + 10});
    const std::optional<StandingView> view = level.view();
    ASSERT_TRUE(view);
    EXPECT_NEAR(view->eye.y - slope(view->eye.x, 0), 1.7f, 0.01f);
}

TEST(StandingView, IsNotForAnObjectOnAPlane) {
    Level object;
    object.addPlane(50);
    object.addBox({-1, 0, -1}, {1, 2, 1});
    EXPECT_FALSE(object.view());
    Level house; // as large as houses are
    house.addPlane(60);
    house.addBox({-6, 0, -5}, {6, 8, 5});
    EXPECT_FALSE(house.view());
}

TEST(StandingView, IsNotForATerrain) {
    Level terrain;
    terrain.addGround(400, [](float x, float z) { return 25 * std::sin(0.03f * x) * std::cos(0.04f * z); });
    EXPECT_FALSE(terrain.view());
    EXPECT_GT(terrain.ground().places.size(), 100u) << "there is ground, but nothing stands around it";
}

TEST(StandingView, IsNotForWhatIsInAClosedRoom) {
    Level room;
    room.addPlane(40);
    room.addBox({-21, 6, -21}, {21, 7, 21}); // a ceiling
    for (const float side : {-21.0f, 20.0f}) {
        room.addBox({side, 0, -21}, {side + 1, 6, 21});
        room.addBox({-20, 0, side}, {20, 6, side + 1});
    }
    EXPECT_FALSE(room.view());
}

TEST(StandingView, IsNotForAModelOfAStreetOrOneInOtherUnits) {
    for (const float scale : {0.1f, 100.0f}) {
        Level level;
        level.addPlane(64 * scale);
        for (const float z : {-15.0f, 5.0f})
            level.addBox(scale * glm::vec3(-30, 0, z), scale * glm::vec3(30, 8, z + 10));
        EXPECT_FALSE(level.view()) << scale;
    }
}

TEST(LevelGround, IsWhereOneCanStandUnderTheSky) {
    Level level;
    level.addPlane(64);
    level.addStreet();
    level.addBox({-30, 1.5f, -4}, {30, 1.6f, -2}); // a shelf that leaves no head room
    const LevelGround ground = level.ground();
    EXPECT_TRUE(ground.sided);
    // Roofs of houses that stand apart are too small, each by itself, and so is the shelf.
    size_t street = 0;
    for (const glm::vec3& place : ground.places) {
        const float up = level.rays().trace(place + glm::vec3(0, 0.01f, 0), {0, 1, 0}).distance;
        ASSERT_TRUE(std::isinf(up)) << place.x << " " << place.y << " " << place.z;
        ASSERT_NEAR(place.y, 0.0f, 1e-4f);
        street += std::abs(place.z) < 5 && std::abs(place.x) < 30 ? 1 : 0;
    }
    EXPECT_GT(street, 100u);
}

TEST(LevelGround, TurnedFacesAreNoticed) {
    Level level;
    level.addGround(
        64, [](float, float) { return 0.0f; }, true);
    EXPECT_FALSE(level.ground().sided);
}

} // namespace
} // namespace relume
