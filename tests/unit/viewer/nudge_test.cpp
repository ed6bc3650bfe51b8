// These tests are about the steps by which keys move and turn what is selected.
#include "app/viewer/edits/nudge.h"

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

namespace relume {
namespace {

// Looks along -Z from the front, a little askew so that no axis is hit exactly.
ViewCamera fromTheFront() {
    ViewCamera camera;
    camera.eye = {0.5f, 0.7f, 5.0f};
    camera.target = glm::vec3(0.0f);
    camera.up = {0, 1, 0};
    return camera;
}

glm::vec3 movedBy(int direction, const ViewCamera& camera) {
    return nudged(glm::mat4(1.0f), {.direction = direction, .diagonal = 10.0f, .camera = camera})[3];
}

TEST(Nudge, GoesAlongTheAxesNearestToThePicture) {
    const ViewCamera front = fromTheFront();
    EXPECT_LT(glm::distance(movedBy(1, front), {0.05f, 0, 0}), 1e-6f);
    EXPECT_LT(glm::distance(movedBy(-1, front), {-0.05f, 0, 0}), 1e-6f);
    EXPECT_LT(glm::distance(movedBy(2, front), {0, 0.05f, 0}), 1e-6f);
    EXPECT_LT(glm::distance(movedBy(3, front), {0, 0, -0.05f}), 1e-6f) << "away from the eye";
    ViewCamera side = front;
    side.eye = {5.0f, 0.7f, 0.5f};
    EXPECT_LT(glm::distance(movedBy(1, side), {0, 0, -0.05f}), 1e-6f);
}

TEST(Nudge, TurnsAboutThePivot) {
    const ViewCamera camera = fromTheFront();
    const glm::mat4 begin = glm::translate(glm::mat4(1.0f), {2, 0, 0});
    const Nudge right{.mode = GizmoMode::Rotate, .direction = 1, .pivot = {1, 0, 0}, .camera = camera};
    glm::mat4 turned = begin;
    for (int i = 0; i < 18; ++i) // by 5 degrees
        turned = nudged(turned, right);
    EXPECT_LT(glm::distance(glm::vec3(turned[3]), {1, 0, -1}), 1e-4f) << "a quarter round the pivot";
    EXPECT_LT(glm::distance(glm::vec3(turned[0]), {0, 0, -1}), 1e-4f) << "and so is its own axis";
    const Nudge left{.mode = GizmoMode::Rotate, .direction = -1, .pivot = {1, 0, 0}, .camera = camera};
    EXPECT_LT(glm::distance(nudged(nudged(begin, right), left)[3], begin[3]), 1e-5f);
}

} // namespace
} // namespace relume
