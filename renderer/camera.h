#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "assets/model/scene.h"
#include "renderer/box.h"

namespace relume {

/// Tells where a picture is seen from. It is a plain value; whatever moves it is a function that returns the
/// moved one.
struct ViewCamera {
    glm::vec3 eye{0.0f, 0.0f, 1.0f}, target{0.0f}; // [m], apart; orbits and zooms go about the target
    glm::vec3 up{0.0f, 1.0f, 0.0f};                // unit; yaw turns about it
    float yfov = 0.8f;                             // [rad], of the picture's height
    float halfHeight = 0.0f;                       // [m], above 0: orthographic, yfov unused
    float znear = 0.01f;                           // [m]
    float zfar = 1000.0f;                          // [m], orthographic only: a perspective has no end

    bool operator==(const ViewCamera&) const = default;
};

glm::vec3 forward(const ViewCamera& camera); // unit
glm::vec3 right(const ViewCamera& camera);   // unit, also where the camera looks along `up`

glm::mat4 viewMatrix(const ViewCamera& camera);
/// Returns the projection; aspect: width / height. Depth runs from 1 at znear to 0 far away, for a clip
/// control of [0, 1]: floats are then as fine far away as they are near by.
glm::mat4 projectionMatrix(const ViewCamera& camera, float aspect);

/// Turns the eye about the target [rad]; it stops short of the poles.
ViewCamera orbit(const ViewCamera& camera, float yaw, float pitch);
/// Turns the target about the eye [rad]; it stops short of the poles.
ViewCamera look(const ViewCamera& camera, float yaw, float pitch);
/// Returns the cameras of a turn about the upright in so many pictures, counter-clockwise, the given one
/// first: about the target, or where the eye is within the box, in its place.
std::vector<ViewCamera> turntable(const ViewCamera& camera, const Box& box, uint32_t count);
/// Moves by shares of the picture's height at the target: right and up.
ViewCamera pan(const ViewCamera& camera, float dx, float dy);
/// Scales the distance to the target (orthographic: the picture's height) by a factor > 0; one below 1 comes
/// closer.
ViewCamera zoom(const ViewCamera& camera, float factor);
/// Moves by metres to the right, up and forward.
ViewCamera fly(const ViewCamera& camera, const glm::vec3& move);
/// Returns a camera of the same direction and angle, from where all of the box is just seen.
ViewCamera frameBox(const ViewCamera& camera, const Box& box, float aspect);

/// Returns the camera for one of a file in a scene with these bounds, which give the target's distance. What
/// shows the horizon level turns about the upright.
ViewCamera cameraOfFile(const Camera& camera, const Box& bounds);
/// Returns a camera at `eye` looking at `target` in a scene with these bounds.
ViewCamera cameraAt(const glm::vec3& eye, const glm::vec3& target, const Box& bounds);

} // namespace relume
