// Rays and distances in a level are held against a search through all its triangles; rooms and preview light
// against levels of which one knows what they are.
#include "assets/survey/preview_light.h"

#include "assets/survey/level_rooms.h"
#include "tests/unit/shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include <glm/gtc/matrix_transform.hpp>

namespace relume {
namespace {

WorldMesh levelOf(const Scene& scene) {
    LightmapAtlas none;
    none.instances.resize(scene.instances.size());
    return flatten(scene, none);
}

Primitive inwards(Primitive primitive) {
    for (size_t i = 0; i < primitive.indices.size(); i += 3)
        std::swap(primitive.indices[i + 1], primitive.indices[i + 2]);
    return primitive;
}

// Makes a room from the origin to this corner, whose faces look inwards; without a ceiling where it is open.
Scene roomOf(const glm::vec3& size, bool open = false) {
    Primitive box = inwards(test::cube());
    if (open) { // the cube's faces come by axis: low x, high x, low y, high y
        constexpr size_t kCeiling = 3, kCorners = 6;
        const auto first = box.indices.begin() + kCeiling * kCorners;
        box.indices.erase(first, first + kCorners);
    }
    Scene scene;
    scene.path = "room.glb";
    test::addInstance(scene, test::addMesh(scene, std::move(box)), glm::scale(glm::mat4(1.0f), size));
    return scene;
}

LevelHit hitByAll(const WorldMesh& mesh, const glm::dvec3& origin, const glm::dvec3& direction) {
    LevelHit nearest;
    for (size_t i = 0; i < mesh.positions.size(); i += 3) {
        const glm::dvec3 p0 = mesh.positions[i], e1 = glm::dvec3(mesh.positions[i + 1]) - p0,
                         e2 = glm::dvec3(mesh.positions[i + 2]) - p0;
        const glm::dmat3 system(e1, e2, -direction);
        if (glm::determinant(system) == 0.0) continue;
        const glm::dvec3 uvt = glm::inverse(system) * (origin - p0);
        if (uvt.x < 0 || uvt.y < 0 || uvt.x + uvt.y > 1 || uvt.z <= 0 || uvt.z >= nearest.distance) continue;
        nearest = {static_cast<float>(uvt.z), glm::dot(glm::cross(e1, e2), direction) < 0};
    }
    return nearest;
}

// Looks at the triangles' points on a grid, which are dense enough for the bound of the test.
double clearanceByAll(const WorldMesh& mesh, const glm::dvec3& point, int steps) {
    double nearest = 1e30;
    for (size_t i = 0; i < mesh.positions.size(); i += 3)
        for (int a = 0; a <= steps; ++a)
            for (int b = 0; a + b <= steps; ++b) {
                const double u = double(a) / steps, v = double(b) / steps;
                const glm::dvec3 at = (1 - u - v) * glm::dvec3(mesh.positions[i]) +
                                      u * glm::dvec3(mesh.positions[i + 1]) +
                                      v * glm::dvec3(mesh.positions[i + 2]);
                nearest = std::min(nearest, glm::distance(at, point));
            }
    return nearest;
}

TEST(LevelRays, MeetWhatASearchThroughAllTrianglesMeets) {
    const WorldMesh mesh = levelOf(test::sceneOf(test::soup(200, 120, 5)));
    const LevelRays rays(mesh);
    std::mt19937 random(3);
    std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
    int hits = 0;
    for (int i = 0; i < 500; ++i) {
        const glm::vec3 origin(unit(random), unit(random), unit(random));
        const glm::vec3 direction(unit(random), unit(random), unit(random));
        const LevelHit hit = rays.trace(origin, direction), wanted = hitByAll(mesh, origin, direction);
        ASSERT_EQ(std::isinf(hit.distance), std::isinf(wanted.distance)) << i;
        if (std::isinf(hit.distance)) continue;
        ++hits;
        EXPECT_NEAR(hit.distance, wanted.distance, 1e-4f * (1.0f + wanted.distance)) << i;
        EXPECT_EQ(hit.front, wanted.front) << i;
    }
    EXPECT_GT(hits, 300);
}

TEST(LevelRays, KnowTheDistanceToTheNearestTriangle) {
    const WorldMesh box = levelOf(test::sceneOf(test::cube()));
    EXPECT_NEAR(LevelRays(box).clearance({0.5f, 0.4f, 0.7f}), 0.3f, 1e-6f) << "to the face in z = 1";
    EXPECT_NEAR(LevelRays(box).clearance({2.0f, 2.0f, 1.0f}), std::sqrt(2.0f), 1e-6f) << "to an edge";
    EXPECT_NEAR(LevelRays(box).clearance({-1, -2, -2}), 3.0f, 1e-6f) << "to a corner";
    const WorldMesh mesh = levelOf(test::sceneOf(test::soup(60, 40, 9)));
    const LevelRays rays(mesh);
    std::mt19937 random(4);
    std::uniform_real_distribution<float> unit(-1.5f, 1.5f);
    for (int i = 0; i < 20; ++i) {
        const glm::vec3 point(unit(random), unit(random), unit(random));
        constexpr int kSteps = 60;
        const double wanted = clearanceByAll(mesh, point, kSteps); // of points up to 2 / 60 apart
        EXPECT_LE(rays.clearance(point), wanted + 1e-5) << i;
        EXPECT_GE(rays.clearance(point), wanted - 0.06) << i;
    }
}

TEST(LevelRooms, ARoomIsClosedUntilItsCeilingIsGone) {
    const glm::vec3 size(4, 3, 6);
    const LevelRooms closed = findRooms(LevelRays(levelOf(roomOf(size))), glm::vec3(0), size);
    EXPECT_TRUE(closed.closed);
    ASSERT_FALSE(closed.places.empty());
    for (const LevelPlace& place : closed.places)
        EXPECT_EQ(place.sky, 0.0f);
    const LevelRooms open = findRooms(LevelRays(levelOf(roomOf(size, true))), glm::vec3(0), size);
    EXPECT_FALSE(open.closed);
    ASSERT_FALSE(open.places.empty());
    // Next to where the ceiling was, half of all directions are sky.
    float most = 0;
    for (const LevelPlace& place : open.places)
        most = std::max(most, place.sky);
    EXPECT_GT(most, 0.3f);
    EXPECT_LT(most, 0.55f);
}

TEST(LevelRooms, NoPlaceIsInsideAnObject) {
    const WorldMesh mesh = levelOf(test::sceneOf(test::cube()));
    const LevelRooms rooms = findRooms(LevelRays(mesh), glm::vec3(-1), glm::vec3(2));
    EXPECT_FALSE(rooms.closed);
    ASSERT_FALSE(rooms.places.empty());
    for (const LevelPlace& place : rooms.places)
        EXPECT_FALSE(glm::all(glm::greaterThan(place.point, glm::vec3(0))) &&
                     glm::all(glm::lessThan(place.point, glm::vec3(1))));
    EXPECT_TRUE(findRooms(LevelRays(mesh), glm::vec3(0), glm::vec3(1)).places.empty());
}

TEST(LevelRooms, TheClearestPointIsFarFromAllWalls) {
    const glm::vec3 size(4, 3, 6);
    const LevelRays rays(levelOf(roomOf(size)));
    const glm::vec3 point = clearestPoint(rays, findRooms(rays, glm::vec3(0), size).places);
    EXPECT_NEAR(rays.clearance(point), 1.5f, 0.015f) << "half the height, the least of the three";
    EXPECT_NEAR(point.y, 1.5f, 0.015f);
}

TEST(PreviewLight, IsALampWhereNoSkyIsSeen) {
    const glm::vec3 size(4, 3, 6);
    const PreviewLight light = previewLight(levelOf(roomOf(size)));
    EXPECT_TRUE(light.closed);
    EXPECT_FALSE(light.sky.radiance != glm::vec3(0.0f));
    ASSERT_EQ(light.lights.size(), 1u);
    EXPECT_EQ(light.lights[0].type, LightType::Point);
    EXPECT_TRUE(light.lights[0].preview);
    const glm::vec3 place(light.lights[0].transform[3]);
    EXPECT_TRUE(glm::all(glm::greaterThan(place, glm::vec3(1))) &&
                glm::all(glm::lessThan(place, size - 1.0f)));
    EXPECT_NEAR(light.lights[0].intensity / (1.5f * 1.5f), 300.0f, 10.0f) << "lux at the nearest surface";
}

TEST(PreviewLight, IsDaylightWhereSkyIsSeen) {
    for (const Scene& scene :
         {roomOf({4, 3, 6}, true), test::sceneOf(test::cube()), test::sceneOf(test::square())}) {
        const PreviewLight light = previewLight(levelOf(scene));
        EXPECT_FALSE(light.closed);
        EXPECT_TRUE(light.sky.preview);
        ASSERT_EQ(light.lights.size(), 1u);
        EXPECT_EQ(light.lights[0].type, LightType::Directional);
        EXPECT_GT(light.lights[0].angle, 0.0f) << "a soft disc";
        EXPECT_LT(-light.lights[0].transform[2].y, -0.5f) << "it shines downwards";
    }
}

TEST(PreviewLight, IsForDarkScenesOnly) {
    Scene scene = roomOf({4, 3, 6});
    EXPECT_TRUE(isDark(scene));
    Scene lamp = scene;
    lamp.lights.emplace_back();
    EXPECT_FALSE(isDark(lamp));
    EXPECT_EQ(addPreviewLight(lamp, levelOf(lamp)), "");
    EXPECT_EQ(lamp.lights.size(), 1u);
    Scene sky = scene;
    sky.sky.radiance = glm::vec3(1.0f);
    EXPECT_FALSE(isDark(sky));
    Scene emitter = scene;
    emitter.materials.emplace_back().emission = glm::vec3(1.0f);
    EXPECT_TRUE(isDark(emitter)) << "no surface has it";
    emitter.meshes[0].primitives[0].material = 0;
    EXPECT_FALSE(isDark(emitter));
    emitter.instances[0].hidden = true;
    EXPECT_TRUE(isDark(emitter));
    EXPECT_EQ(addPreviewLight(scene, levelOf(scene)), "a preview lamp");
    EXPECT_EQ(scene.lights.size(), 1u);
}

} // namespace
} // namespace relume
