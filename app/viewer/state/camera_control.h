#pragma once

#include "renderer/camera.h"

namespace relume {

/// Moves a camera by what mouse and keyboard do. It knows no window.
class CameraControl {
public:
    enum class Drag { None, Orbit, Pan, Look };
    /// The directions of flight that are held: right, up and forward, each -1, 0 or 1.
    struct Flight {
        glm::ivec3 held{0};
        bool fast = false;
    };

    const ViewCamera& camera() const { return camera_; }
    const Box& bounds() const { return bounds_; } // of the scene
    /// Sets the camera, and the scene's bounds, which give the speed of flight.
    void set(const ViewCamera& camera, const Box& bounds);
    void set(const ViewCamera& camera) { set(camera, bounds_); }
    /// Sets the camera that reset() goes back to.
    void setHome(const ViewCamera& home) { home_ = home; }
    void reset() { set(home_); }

    void begin(Drag drag) { drag_ = drag; }
    void end() { drag_ = Drag::None; }
    bool dragging() const { return drag_ != Drag::None; }
    /// Follows the cursor, which went so far in shares of the picture's height, y down. Returns false where
    /// nothing moved.
    bool move(float dx, float dy);
    /// Zooms by steps of a wheel; above 0 the camera comes closer.
    void zoomBy(float steps);
    void setFlight(const Flight& flight) { flight_ = flight; }
    bool flying() const { return flight_.held != glm::ivec3(0); }
    /// Flies on for so many seconds. Returns false where nothing moved.
    bool fly(double seconds);
    void frame(const Box& box, float aspect);
    /// Returns how far a flight goes in one second [m].
    float speed() const;

private:
    ViewCamera camera_, home_;
    Box bounds_;
    Drag drag_ = Drag::None;
    Flight flight_;
};

} // namespace relume
