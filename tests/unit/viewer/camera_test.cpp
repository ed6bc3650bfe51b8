#include "renderer/camera.h"
#include "renderer/camera_path.h"
#include "renderer/frustum.h"

#include <gtest/gtest.h>

#include <algorithm>

#include <cmath>

#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>

namespace relume {
namespace {

Box unitBox() {
    Box box;
    box.add(glm::vec3(-1.0f));
    box.add(glm::vec3(1.0f));
    return box;
}

ViewCamera along(const glm::vec3& eye, const glm::vec3& target) {
    ViewCamera camera;
    camera.eye = eye;
    camera.target = target;
    return camera;
}

void expectNear(const glm::vec3& a, const glm::vec3& b, float tolerance = 1e-5f) {
    EXPECT_NEAR(a.x, b.x, tolerance);
    EXPECT_NEAR(a.y, b.y, tolerance);
    EXPECT_NEAR(a.z, b.z, tolerance);
}

// Returns where a point comes to lie: x and y from -1 to 1, z the depth.
glm::vec3 project(const ViewCamera& camera, float aspect, const glm::vec3& point) {
    const glm::vec4 clip = projectionMatrix(camera, aspect) * viewMatrix(camera) * glm::vec4(point, 1.0f);
    return glm::vec3(clip) / clip.w;
}

TEST(Camera, ProjectsTheTargetToTheMiddleAndTheAngleToTheEdge) {
    ViewCamera camera = along({1, 2, 3}, {1, 2, -7});
    camera.yfov = glm::half_pi<float>();
    const glm::vec3 middle = project(camera, 2.0f, camera.target);
    EXPECT_NEAR(middle.x, 0.0f, 1e-6f);
    EXPECT_NEAR(middle.y, 0.0f, 1e-6f);
    // These are 45 degrees up, and twice as far to the right, as an aspect of 2 allows.
    expectNear(project(camera, 2.0f, {1, 12, -7}), {0, 1, 0.001f});
    expectNear(project(camera, 2.0f, {21, 2, -7}), {1, 0, 0.001f});
}

TEST(Camera, GivesDepthOneNearAndZeroFarAway) {
    const ViewCamera camera = along({0, 0, 0}, {0, 0, -1});
    EXPECT_NEAR(project(camera, 1.0f, {0, 0, -camera.znear}).z, 1.0f, 1e-6f);
    EXPECT_LT(project(camera, 1.0f, {0, 0, -1e6f}).z, 1e-6f);
    ViewCamera flat = camera;
    flat.halfHeight = 2.0f;
    flat.znear = 1.0f;
    flat.zfar = 5.0f;
    EXPECT_NEAR(project(flat, 1.0f, {0, 0, -1}).z, 1.0f, 1e-6f);
    EXPECT_NEAR(project(flat, 1.0f, {0, 0, -5}).z, 0.0f, 1e-6f);
    expectNear(project(flat, 2.0f, {4, 2, -5}), {1, 1, 0});
}

TEST(Camera, OrbitsAtAConstantDistance) {
    const ViewCamera camera = along({0, 0, 5}, {0, 0, 0});
    const ViewCamera side = orbit(camera, glm::half_pi<float>(), 0.0f);
    expectNear(side.eye, {5, 0, 0});
    expectNear(side.target, camera.target);
    const ViewCamera above = orbit(camera, 0.3f, 0.7f);
    EXPECT_NEAR(glm::length(above.eye), 5.0f, 1e-5f);
    EXPECT_NEAR(above.eye.y, 5.0f * std::sin(0.7f), 1e-5f);
    expectNear(orbit(orbit(camera, 0.4f, 0.2f), -0.4f, -0.2f).eye, camera.eye);
}

TEST(Camera, StopsShortOfThePoles) {
    const ViewCamera top = orbit(along({0, 0, 5}, {0, 0, 0}), 0.0f, 10.0f);
    EXPECT_GT(top.eye.y, 4.99f);
    EXPECT_GT(top.eye.z, 0.0f); // not over it
    const ViewCamera lowest = look(along({0, 0, 5}, {0, 0, 0}), 0.0f, -10.0f);
    EXPECT_LT(lowest.target.y, -4.99f);
    EXPECT_LT(lowest.target.z, 5.0f);
    // A camera that looks along `up` has a picture, too.
    const glm::mat4 view = viewMatrix(along({0, 5, 0}, {0, 0, 0}));
    EXPECT_NEAR(glm::determinant(view), 1.0f, 1e-5f);
}

TEST(Camera, LooksAroundFromWhereItStands) {
    const ViewCamera camera = look(along({0, 0, 5}, {0, 0, 0}), glm::half_pi<float>(), 0.0f);
    expectNear(camera.eye, {0, 0, 5});
    expectNear(camera.target, {-5, 0, 5}); // counter-clockwise seen from above, as orbits are
}

TEST(Camera, PansByThePicturesHeight) {
    ViewCamera camera = along({0, 0, 5}, {0, 0, 0});
    camera.yfov = glm::half_pi<float>();
    const ViewCamera moved = pan(camera, 0.5f, -0.25f); // the picture is 10 m high at the target
    expectNear(moved.eye, {5, -2.5f, 5});
    expectNear(moved.target, {5, -2.5f, 0});
}

TEST(Camera, ZoomsAndFlies) {
    const ViewCamera camera = along({0, 0, 5}, {0, 0, 1});
    expectNear(zoom(camera, 0.5f).eye, {0, 0, 3});
    expectNear(fly(camera, {1, 2, 3}).eye, {1, 2, 2});
    expectNear(fly(camera, {1, 2, 3}).target, {1, 2, -2});
    ViewCamera flat = camera;
    flat.halfHeight = 4.0f;
    EXPECT_FLOAT_EQ(zoom(flat, 0.5f).halfHeight, 2.0f);
    expectNear(zoom(flat, 0.5f).eye, camera.eye);
}

// All corners are in the picture and one is at its edge.
TEST(Camera, FramesABoxExactly) {
    for (const float aspect : {0.5f, 1.0f, 2.0f}) {
        for (const float halfHeight : {0.0f, 1.0f}) {
            ViewCamera camera = along({3, 2, 5}, {0, 0, 0});
            camera.halfHeight = halfHeight;
            camera = frameBox(camera, unitBox(), aspect);
            float largest = 0.0f;
            for (int i = 0; i < 8; ++i) {
                const glm::vec3 place = project(camera, aspect, unitBox().corner(i));
                largest = std::max({largest, std::abs(place.x), std::abs(place.y)});
                EXPECT_GT(place.z, 0.0f);
                EXPECT_LT(place.z, 1.0f);
            }
            EXPECT_NEAR(largest, 1.0f, 1e-4f) << aspect << " " << halfHeight;
        }
    }
}

TEST(Camera, TakesAFilesCamera) {
    Camera file;
    file.transform =
        glm::translate(glm::mat4(1.0f), {0, 1, 8}) * glm::rotate(glm::mat4(1.0f), 0.2f, {0, 0, 1});
    file.yfov = 0.7f;
    const ViewCamera camera = cameraOfFile(file, unitBox());
    expectNear(camera.eye, {0, 1, 8});
    expectNear(camera.target, {0, 1, 0}); // level with the scene's middle
    expectNear(right(camera), glm::vec3(file.transform[0]));
    EXPECT_FLOAT_EQ(camera.yfov, 0.7f);
    EXPECT_FLOAT_EQ(camera.znear, file.znear);
}

// A file's camera that looks down, as most do: its own up leans back.
Camera lookingDown(const glm::vec3& eye, const glm::vec3& target) {
    Camera file;
    file.transform = glm::inverse(glm::lookAt(eye, target, {0, 1, 0}));
    return file;
}

TEST(Camera, OfAFileTurnsAboutTheUprightUnlessItIsRolled) {
    const Camera file = lookingDown({5, 4, 7}, {0, 0.8f, -1});
    const ViewCamera camera = cameraOfFile(file, unitBox());
    expectNear(right(camera), glm::vec3(file.transform[0])); // the picture is the file's
    for (const float yaw : {0.5f, 2.0f, 3.14f}) {
        const ViewCamera moved = orbit(camera, yaw, 0.0f);
        EXPECT_NEAR(moved.eye.y, camera.eye.y, 1e-5f); // it had gone below the ground
        EXPECT_NEAR(right(moved).y, 0.0f, 1e-6f);      // the horizon had been tilted
        EXPECT_NEAR(right(look(camera, yaw, 0.2f)).y, 0.0f, 1e-6f);
    }
    Camera rolled = file;
    rolled.transform = file.transform * glm::rotate(glm::mat4(1.0f), 0.01f, {0, 0, 1});
    expectNear(right(cameraOfFile(rolled, unitBox())), glm::vec3(rolled.transform[0]));
    Camera onItsHead = file;
    onItsHead.transform = file.transform * glm::rotate(glm::mat4(1.0f), glm::pi<float>(), {0, 0, 1});
    expectNear(right(cameraOfFile(onItsHead, unitBox())), glm::vec3(onItsHead.transform[0]));
    Camera plan;
    plan.transform = glm::translate(glm::mat4(1.0f), {0, 9, 0}) *
                     glm::rotate(glm::mat4(1.0f), -glm::half_pi<float>(), {1, 0, 0});
    expectNear(right(cameraOfFile(plan, unitBox())), {1, 0, 0});
}

TEST(Turntable, KeepsEachPictureUprightHoweverTheCameraLooks) {
    ViewCamera rolled = along({3, 4, 5}, {0, 1, 0});
    rolled.up = glm::normalize(glm::vec3(0.3f, 1.0f, -0.2f));
    const float tilt = right(rolled).y;
    for (const ViewCamera& camera : turntable(rolled, unitBox(), 7)) {
        EXPECT_NEAR(camera.eye.y, 4.0f, 1e-5f);
        EXPECT_NEAR(right(camera).y, tilt, 1e-6f);
        EXPECT_NEAR(glm::distance(camera.eye, camera.target), glm::distance(rolled.eye, rolled.target),
                    1e-5f);
    }
    const std::vector<ViewCamera> plan = turntable(along({0, 9, 0}, {0, 0, 0}), unitBox(), 4);
    for (size_t i = 1; i < plan.size(); ++i) { // seen from straight above, the plan turns
        expectNear(plan[i].eye, {0, 9, 0});
        EXPECT_NEAR(glm::dot(right(plan[i - 1]), right(plan[i])), 0.0f, 1e-6f);
    }
}

TEST(Frustum, SeesWhatIsInThePictureOnly) {
    ViewCamera camera = along({0, 0, 5}, {0, 0, 0});
    camera.yfov = glm::half_pi<float>();
    const Frustum frustum(projectionMatrix(camera, 1.0f) * viewMatrix(camera));
    const auto at = [](float x, float y, float z) {
        Box box = unitBox();
        box.low += glm::vec3(x, y, z);
        box.high += glm::vec3(x, y, z);
        return box;
    };
    EXPECT_TRUE(frustum.sees(at(0, 0, 0)));
    EXPECT_TRUE(frustum.sees(at(5.5f, 0, 0))); // the edge goes through it
    EXPECT_FALSE(frustum.sees(at(8, 0, 0)));
    EXPECT_FALSE(frustum.sees(at(-8, 0, 0)));
    EXPECT_FALSE(frustum.sees(at(0, 8, 0)));
    EXPECT_FALSE(frustum.sees(at(0, -8, 0)));
    EXPECT_FALSE(frustum.sees(at(0, 0, 7))); // behind the eye
    EXPECT_TRUE(frustum.sees(at(0, 0, 5)));  // around it
    EXPECT_TRUE(frustum.sees(at(0, 0, -1e6f)));
}

TEST(Turntable, TurnsAboutTheTargetOutsideAndInPlaceInside) {
    const Box box{glm::vec3(-1), glm::vec3(1)};
    const ViewCamera outside = along({0, 0, 5}, {0, 0, 0});
    const std::vector<ViewCamera> around = turntable(outside, box, 4);
    ASSERT_EQ(around.size(), 4u);
    EXPECT_EQ(around[0], outside);
    expectNear(around[1].eye, {5, 0, 0}); // counter-clockwise seen from above
    expectNear(around[2].eye, {0, 0, -5});
    for (const ViewCamera& camera : around)
        expectNear(camera.target, {0, 0, 0});
    const ViewCamera inside = along({0, 0, 0.5f}, {0, 0, 0});
    for (const ViewCamera& camera : turntable(inside, box, 3)) {
        EXPECT_EQ(camera.eye, inside.eye);
        EXPECT_NEAR(glm::distance(camera.eye, camera.target), 0.5f, 1e-6f);
    }
}

TEST(CameraPath, GoesThroughAllStops) {
    std::vector<ViewCamera> stops = {along({0, 0, 5}, {0, 0, 0}), along({5, 1, 0}, {0, 0, 0}),
                                     along({0, 2, -5}, {0, 0, 0}), along({-4, 0, 0}, {0, 1, 0})};
    stops[1].yfov = 0.5f;
    const std::vector<ViewCamera> way = cameraPath(stops, 31);
    ASSERT_EQ(way.size(), 31u);
    for (size_t i = 0; i < stops.size(); ++i)
        EXPECT_EQ(way[10 * i], stops[i]) << i;
    for (size_t i = 1; i < way.size(); ++i) {
        EXPECT_LT(glm::distance(way[i - 1].eye, way[i].eye), 1.1f) << i;
        EXPECT_LT(std::acos(std::min(glm::dot(forward(way[i - 1]), forward(way[i])), 1.0f)), 0.25f) << i;
        EXPECT_NEAR(glm::length(way[i].up), 1.0f, 1e-5f);
    }
    EXPECT_NEAR(way[5].yfov, 0.5f * (stops[0].yfov + 0.5f), 1e-6f);
}

// Neither the way nor the turn has a kink at a stop: what changes there from picture to picture changes
// little.
TEST(CameraPath, HasNoKinkAtAStop) {
    const std::vector<ViewCamera> stops = {along({0, 0, 5}, {0, 0, 0}), along({5, 0, 0}, {0, 0, 0}),
                                           along({0, 0, -5}, {0, 0, 0})};
    constexpr uint32_t kPictures = 2001;
    const std::vector<ViewCamera> way = cameraPath(stops, kPictures);
    const size_t middle = kPictures / 2;
    const glm::vec3 before = way[middle].eye - way[middle - 1].eye,
                    after = way[middle + 1].eye - way[middle].eye;
    EXPECT_LT(glm::distance(before, after), 0.01f * glm::length(after));
    const glm::vec3 turnBefore = forward(way[middle]) - forward(way[middle - 1]),
                    turnAfter = forward(way[middle + 1]) - forward(way[middle]);
    EXPECT_LT(glm::distance(turnBefore, turnAfter), 0.01f * glm::length(turnAfter));
    EXPECT_GT(glm::length(turnAfter), 0.0f);
}

TEST(CameraPath, TakesTheShorterWayAroundAndKeepsTheKindOfCamera) {
    ViewCamera front = along({0, 0, 5}, {0, 0, 0}), back = along({0.1f, 0, -5}, {0, 0, 0});
    const std::vector<ViewCamera> half = cameraPath(std::vector{front, back}, 3);
    EXPECT_NEAR(std::abs(forward(half[1]).x), 1.0f, 1e-3f) << "half way around, level";
    EXPECT_NEAR(half[1].up.y, 1.0f, 1e-3f);
    back.halfHeight = 2.0f;
    const std::vector<ViewCamera> mixed = cameraPath(std::vector{front, back}, 5);
    EXPECT_EQ(mixed[1].halfHeight, 0.0f);
    EXPECT_EQ(mixed[3].halfHeight, 2.0f);
}

} // namespace
} // namespace relume
