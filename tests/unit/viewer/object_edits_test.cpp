#include "app/viewer/edits/light_edits.h"
#include "app/viewer/edits/object_edits.h"

#include <gtest/gtest.h>

#include <algorithm>

#include <glm/gtc/matrix_transform.hpp>

namespace relume {
namespace {

const glm::mat4 kOne(1.0f);

float off(const glm::mat4& a, const glm::mat4& b) {
    float most = 0;
    for (int column = 0; column < 4; ++column)
        most = std::max(most, glm::distance(a[column], b[column]));
    return most;
}

glm::mat4 pose(const glm::vec3& place, const glm::vec3& degrees, const glm::vec3& scale) {
    return glm::scale(withAngles(glm::translate(kOne, place), degrees), scale);
}

TEST(ObjectEdits, PosesAreReadAsTheyWereTyped) {
    const glm::vec3 place(1, 2, 3), degrees(30, -50, 100);
    for (const glm::vec3& scale : {glm::vec3(1), glm::vec3(2, 0.5f, 3), glm::vec3(-2, 1, 1)}) {
        const glm::mat4 transform = pose(place, degrees, scale);
        EXPECT_LT(glm::distance(anglesOf(transform), degrees), 1e-3f) << scale.x;
        EXPECT_LT(glm::distance(scaleOf(transform), scale), 1e-5f) << scale.x;
        const glm::vec3 other(-80, 20, 5), larger = 3.0f * scale;
        EXPECT_LT(off(turnedTo(transform, other), pose(place, other, scale)), 1e-4f) << scale.x;
        EXPECT_LT(off(scaledTo(transform, larger), pose(place, degrees, larger)), 1e-4f) << scale.x;
    }
}

TEST(ObjectEdits, ShearStaysWhereOneTurns) {
    glm::mat4 sheared = kOne;
    sheared[1] = {0.5f, 1.0f, 0.0f, 0.0f};
    const glm::mat4 turned = turnedTo(sheared, {90.0f, 0.0f, 0.0f});
    EXPECT_NEAR(glm::dot(turned[0], turned[1]), glm::dot(sheared[0], sheared[1]), 1e-5f);
    EXPECT_LT(off(turnedTo(turned, {0.0f, 0.0f, 0.0f}), sheared), 1e-5f);
}

/// Holds a floor and a plate that its file has turned and scaled.
class PlacedObject : public testing::Test {
protected:
    PlacedObject() {
        std::vector<Instance>& instances = scene_.prepared.scene.instances;
        instances.resize(2);
        instances[1].name = "Plate";
        instances[1].transform = plate_;
        WorldMesh& mesh = scene_.prepared.mesh;
        add(mesh, 0, kOne);
        add(mesh, 1, plate_);
        scene_.geometry.draws.resize(2);
        scene_.geometry.draws[1].instance = 1;
        for (size_t i = 0; i < mesh.positions.size(); ++i)
            scene_.geometry.draws[mesh.instance[i / 3]].bounds.add(mesh.positions[i]);
        edits_ = editsOf(scene_.prepared.scene);
    }
    // Adds two triangles in y = 0 around the origin, facing +y.
    static void add(WorldMesh& mesh, uint32_t instance, const glm::mat4& transform) {
        for (const glm::vec3& corner : {glm::vec3(-1, 0, 1), glm::vec3(1, 0, 1), glm::vec3(1, 0, -1),
                                        glm::vec3(-1, 0, 1), glm::vec3(1, 0, -1), glm::vec3(-1, 0, -1)})
            mesh.positions.emplace_back(transform * glm::vec4(corner, 1.0f));
        mesh.instance.insert(mesh.instance.end(), 2, instance);
        mesh.material.insert(mesh.material.end(), 2, 0u);
    }

    glm::mat4 plate_ = pose({5, 1, 0}, {20, 0, 0}, {2, 2, 2});
    LoadedScene scene_;
    SceneEdits edits_;
};

TEST_F(PlacedObject, HasANameInAnyCase) {
    EXPECT_EQ(objectName(scene_.prepared.scene, 0), "instance 0");
    EXPECT_EQ(objectName(scene_.prepared.scene, 1), "Plate");
}

TEST_F(PlacedObject, ItsPivotGoesAlong) {
    EXPECT_EQ(placementOf(scene_, edits_, 1), kOne);
    const std::optional<glm::vec3> pivot = pivotOf(scene_, edits_, 1);
    ASSERT_TRUE(pivot);
    EXPECT_LT(glm::distance(*pivot, glm::vec3(5, 1, 0)), 1e-4f);
    const glm::mat4 move = glm::translate(kOne, {0, 3, -1});
    edits_.placements[1].transform = move * plate_;
    EXPECT_LT(off(placementOf(scene_, edits_, 1), move), 1e-4f);
    EXPECT_LT(glm::distance(pivotOf(scene_, edits_, 1).value(), glm::vec3(5, 4, -1)), 1e-4f);
}

TEST_F(PlacedObject, ItsBoundsGoAlong) {
    const glm::vec3 middle = placedBounds(scene_, edits_, 1).centre();
    EXPECT_LT(glm::distance(middle, glm::vec3(5, 1, 0)), 1e-4f);
    edits_.placements[1].transform = glm::translate(kOne, {0, 3, -1}) * plate_;
    EXPECT_LT(glm::distance(placedBounds(scene_, edits_, 1).centre(), glm::vec3(5, 4, -1)), 1e-4f);
}

TEST_F(PlacedObject, ASurfaceIsWhereTheEditPutIt) {
    const glm::vec3 towards(0, 0.6f, 0.8f);
    EXPECT_LT(glm::distance(placedNormalAt(scene_, edits_, 0, {0, 0, 0}, towards), {0, 1, 0}), 1e-4f);
    edits_.placements[0].transform = glm::rotate(kOne, glm::radians(90.0f), {1, 0, 0});
    EXPECT_LT(glm::distance(placedNormalAt(scene_, edits_, 0, {0, 0.5f, 0}, towards), {0, 0, 1}), 1e-4f);
}

TEST_F(PlacedObject, RestsOnASurface) {
    // On edge, it reaches 2 m below its middle.
    const glm::mat4 begin = glm::translate(kOne, {5, 1, 0}) *
                            glm::rotate(kOne, glm::radians(90.0f), {0, 0, 1}) *
                            glm::translate(kOne, {-5, -1, 0}) * pose({5, 1, 0}, {0, 0, 0}, {2, 2, 2});
    scene_.prepared.scene.instances[1].transform = pose({5, 1, 0}, {0, 0, 0}, {2, 2, 2});
    scene_.prepared.mesh.positions.resize(6);
    scene_.prepared.mesh.instance.resize(2);
    add(scene_.prepared.mesh, 1, scene_.prepared.scene.instances[1].transform);
    const glm::mat4 rests =
        restingOn({.scene = scene_, .instance = 1, .begin = begin}, {0.5f, 0.25f, 0.5f}, {0, 1, 0});
    EXPECT_LT(glm::distance(glm::vec3(rests[3]), glm::vec3(0.5f, 2.25f, 0.5f)), 1e-3f);
    EXPECT_EQ(rests[0], begin[0]);
}

} // namespace
} // namespace relume
