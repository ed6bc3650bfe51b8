#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "app/live/session.h"
#include "app/viewer/edits/light_edits.h"
#include "app/viewer/picture/lightmap_bridge.h"
#include "app/viewer/picture/scene_pane.h"
#include "app/viewer/state/camera_control.h"
#include "app/viewer/state/feedback.h"
#include "app/viewer/state/picture_area.h"
#include "app/viewer/state/view_state.h"

namespace relume {

/// The session's scene as it is seen in the window: camera and view, the newest map, the picture of both, and
/// where in the window it lies. It belongs to the current OpenGL context.
class SceneView {
public:
    static constexpr double kRestsAfter = 0.25; // [s] without a move until the camera counts as still

    /// The first three must outlive it. `software` is explained at ScenePane.
    SceneView(const Session& session, LightmapExchange& exchange, Feedback& feedback, bool software);

    ViewState& state() { return state_; }
    const ViewState& state() const { return state_; }
    CameraControl& camera() { return camera_; }
    const CameraControl& camera() const { return camera_; }
    ScenePane& pane() { return pane_; }
    const ScenePane& pane() const { return pane_; }

    /// Takes the newest map. Returns whether there is a newer one.
    bool takeMap();
    bool waitsForMaps() const { return bridge_.waiting(); }
    /// Returns the map that was taken last, which may show a former scene; nullptr: none yet.
    const PublishedMap* newestMap() const { return bridge_.map(); }
    /// Returns the map of this scene, nullptr: none yet.
    const PublishedMap* map() const;
    ScenePane::Look look() const;

    /// Sets the session's scene. Returns why it cannot be drawn, in one line, which the log has told too; ""
    /// where it can.
    [[nodiscard]] std::string setScene(const LoadedScene& scene);
    /// Follows Session::early(): its geometry is shown until its scene is there; where that cannot be read,
    /// the former scene is shown again, as it was seen. `firstCamera` chooses the view. Call it once per
    /// frame, after the scene came. Returns whether another geometry is shown.
    bool followEarly(const std::function<ViewCamera(const LoadedScene&)>& firstCamera);
    /// Tells whether this scene's geometry has been shown: the camera may have been moved since.
    bool wasEarly(const LoadedScene& scene) const { return early_.number == scene.number; }

    /// Sets where the picture lies. `scale` is that of text and controls, `pixels` the size of a screen
    /// coordinate.
    void place(const PictureArea& area, float scale, float pixels);
    const PictureArea& area() const { return area_; }
    float scale() const { return scale_; }
    /// Returns a point of the window as one of the picture [points].
    glm::vec2 pointAt(const glm::dvec2& at) const { return (glm::vec2(at) - area_.corner) / scale_; }
    /// Returns what is at a point of the window, or what is behind the instance `without`.
    std::optional<Pick> pick(const glm::dvec2& at, std::optional<uint32_t> without = {});
    /// Returns the user's view, by which lights that they add are placed.
    LightSpot lightSpot();
    /// Tells whether icons of lights and the gizmo lie over the picture.
    bool showsLights() const;
    /// Draws the picture, a new one where `anew` says so or the size changed, into a window of this size
    /// [pixels]. Returns whether it is a new one.
    bool draw(bool anew, const glm::uvec2& window);

    /// Follow the mouse: a drag by so much and steps of the wheel [screen coordinates] move the camera, or
    /// the lightmap where that is shown as a flat picture.
    void drag(const glm::dvec2& way);
    void zoom(float steps, const glm::dvec2& at);
    /// Flies on to this time [s].
    void fly(const CameraControl::Flight& flight, double time);
    void frameAll();
    void seeFrom(const ViewCamera& camera);
    void cameraMoved();
    /// Returns the time [s] at which the camera moved last.
    double movedAt() const { return moved_; }
    /// Tells whether the camera has not moved for so long that it counts as still.
    bool rests(double time) const { return time - moved_ >= kRestsAfter; }

private:
    /// A scene that is shown before it is there.
    struct Early {
        std::unique_ptr<ScenePane> pane; // nullptr: nothing is
        uint64_t number = 0;             // of the newest one, LoadedScene::number
        ViewCamera former;               // by which the scene before was seen
    };
    ScenePane& shownPane() { return early_.pane ? *early_.pane : pane_; }

    const Session& session_;
    Feedback& feedback_;
    ViewState state_;
    CameraControl camera_;
    ScenePane pane_;
    Early early_;
    LightmapBridge bridge_;
    uint64_t mapVersion_ = 0; // of the newest map
    PictureArea area_;        // as in the last frame, like the two below
    float scale_ = 1, pixels_ = 1;
    double flown_ = 0;    // when the flight went on last
    double moved_ = -1e9; // when the camera moved last
};

} // namespace relume
