#pragma once

#include <optional>
#include <string>

#include "app/viewer/panels/item_log.h"
#include "app/viewer/picture/light_overlay.h"
#include "app/viewer/picture/shown_lights.h"
#include "app/viewer/shell/editing.h"
#include "app/viewer/window/window.h"

namespace relume {

/// Moves, turns and hides what is selected, an analytic light or an object: by the gizmo and by keys. It
/// draws the gizmo and the icons of lights, and tells what is under the cursor.
class Mover {
public:
    /// All that it is given must outlive it.
    Mover(const Session& session, SceneView& picture, const ShownLights& lights, Editing& editing,
          Feedback& feedback);

    /// Puts the ball that is lit by its place into the scene, selected, or takes it away.
    void toggleBall();
    /// Selects the ball where it is seen at a point of the window, before the surface `behind`.
    bool selectBallAt(const glm::dvec2& at, const std::optional<Pick>& behind);

    /// Does Nudge, HideObject or ShowObjects.
    void perform(Action action, int argument);

    /// Follow the mouse, at points of the window. press() returns whether it takes hold of the gizmo, which
    /// it does until release(). `control` says that Ctrl is held: a light or an object then goes along the
    /// surface below, and turns come in steps.
    bool press(const glm::dvec2& at);
    bool held() const { return drag_.has_value(); }
    void drag(const glm::dvec2& at, bool control);
    void release();
    /// Follows a key while the gizmo is held, with the cursor at a point.
    void takeKey(const WindowEvent& key, const glm::dvec2& at, bool control);
    /// Lets go without an end of the edit: another scene came.
    void sceneCame() { drag_.reset(); }

    /// Returns the light whose icon is at a point of the window, or nothing where none is.
    std::optional<LightKey> iconAt(const glm::dvec2& at) const;
    /// Draws icons and gizmo, and tells where they are. `cursor` is where one may take hold, if anywhere.
    void draw(const std::optional<glm::dvec2>& cursor, ui::ItemLog& items) const;

private:
    LightStage stage() const;
    std::optional<uint32_t> object() const;
    bool holdsBall() const;
    void selectBall();
    void dragBall(const glm::dvec2& at, bool control);
    glm::mat4* target(Document& document) const;
    std::string name() const;
    void nudge(int direction);
    void toggleHidden();
    void showAll();
    std::optional<glm::mat4> onSurface(const glm::dvec2& at) const;
    void tellPlaces(ui::ItemLog& items) const;

    const Session& session_;
    SceneView& picture_;
    const ShownLights& lights_;
    Editing& editing_;
    Feedback& feedback_;
    std::optional<GizmoDrag> drag_;
};

} // namespace relume
