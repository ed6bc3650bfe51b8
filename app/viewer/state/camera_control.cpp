#include "app/viewer/state/camera_control.h"

#include <algorithm>
#include <cmath>

#include <glm/gtc/constants.hpp>

namespace relume {
namespace {

constexpr float kOrbitTurn = glm::pi<float>(); // [rad] over the picture's height: half round in one sweep
constexpr float kZoomStep = 0.85f;             // distance after one step of a wheel
constexpr float kCrossing = 4.0f;              // [s] that a flight through the whole scene takes
constexpr float kFaster = 4.0f;                // with Shift
constexpr float kNearest = 1e-4f, kFarthest = 1e4f; // of the scene's diagonal: where zooming ends
constexpr double kLongestStep = 0.1;                // [s]: a stall must not throw one out of the scene

} // namespace

void CameraControl::set(const ViewCamera& camera, const Box& bounds) {
    camera_ = camera;
    bounds_ = bounds;
}

bool CameraControl::move(float dx, float dy) {
    if (dx == 0 && dy == 0) return false;
    switch (drag_) {
    case Drag::None:
        return false;
    case Drag::Orbit:
        camera_ = orbit(camera_, -kOrbitTurn * dx, -kOrbitTurn * dy);
        break;
    case Drag::Pan:
        camera_ = pan(camera_, -dx, dy);
        break;
    // The point under the cursor stays under it.
    case Drag::Look:
        camera_ = look(camera_, camera_.yfov * dx, camera_.yfov * dy);
        break;
    }
    return true;
}

void CameraControl::zoomBy(float steps) {
    const float size = bounds_.empty() ? 1.0f : std::max(bounds_.diagonal(), 1e-6f);
    const bool flat = camera_.halfHeight > 0.0f;
    const float now = flat ? camera_.halfHeight : glm::distance(camera_.eye, camera_.target);
    const float wanted =
        std::clamp(now * std::pow(kZoomStep, steps), kNearest * size, std::max(kFarthest * size, now));
    camera_ = zoom(camera_, wanted / now);
}

float CameraControl::speed() const {
    const float size = bounds_.empty() ? 1.0f : bounds_.diagonal();
    return size / kCrossing * (flight_.fast ? kFaster : 1.0f);
}

bool CameraControl::fly(double seconds) {
    if (!flying() || seconds <= 0) return false;
    const auto distance = speed() * static_cast<float>(std::min(seconds, kLongestStep));
    camera_ = relume::fly(camera_, distance * glm::normalize(glm::vec3(flight_.held)));
    return true;
}

void CameraControl::frame(const Box& box, float aspect) {
    if (!box.empty()) camera_ = frameBox(camera_, box, aspect);
}

} // namespace relume
