#include "app/viewer/edits/nudge.h"

#include <cmath>
#include <cstdlib>

#include <glm/gtc/matrix_transform.hpp>

namespace relume {
namespace {

constexpr float kNudge = 0.005f;   // of the scene's diagonal
constexpr float kNudgeTurn = 5.0f; // [degrees]

// Returns the axes of the world, with their signs, that point the most to the right of a picture, up and
// forward in it.
glm::mat3 nearestAxes(const ViewCamera& camera) {
    const glm::vec3 side = right(camera), front = forward(camera), up = glm::cross(side, front);
    glm::mat3 axes(0.0f);
    glm::bvec3 taken(false);
    for (const int row : {0, 1, 2}) {
        const glm::vec3 wanted = row == 0 ? side : row == 1 ? up : front;
        int best = -1;
        for (int axis = 0; axis < 3; ++axis)
            if (!taken[axis] && (best < 0 || std::abs(wanted[axis]) > std::abs(wanted[best]))) best = axis;
        taken[best] = true;
        axes[row][best] = wanted[best] < 0 ? -1.0f : 1.0f;
    }
    return axes;
}

} // namespace

glm::mat4 nudged(const glm::mat4& transform, const Nudge& nudge) {
    const glm::mat3 axes = nearestAxes(nudge.camera);
    const float sign = nudge.direction < 0 ? -1.0f : 1.0f;
    const int along = std::abs(nudge.direction) - 1;
    if (nudge.mode == GizmoMode::Translate) {
        glm::mat4 moved = transform;
        moved[3] += glm::vec4(sign * kNudge * nudge.diagonal * axes[along], 0.0f);
        return moved;
    }
    // To the right it turns about what points up, upwards about what points right.
    const glm::vec3 axis = along == 0 ? axes[1] : along == 1 ? axes[0] : axes[2];
    const glm::mat4 turn = glm::rotate(glm::mat4(1.0f), glm::radians(sign * kNudgeTurn), axis);
    const glm::vec3 arm = glm::vec3(transform[3]) - nudge.pivot;
    glm::mat4 turned = turn * transform;
    turned[3] = glm::vec4(nudge.pivot + glm::mat3(turn) * arm, 1.0f);
    return turned;
}

} // namespace relume
