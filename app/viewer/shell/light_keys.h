#pragma once

#include "app/viewer/edits/light_actions.h"
#include "app/viewer/picture/shown_lights.h"
#include "app/viewer/shell/editing.h"

namespace relume {

/// Adds, changes and deletes lights as keys and menus ask, and selects what came of it.
class LightKeys {
public:
    /// All that it is given must outlive it.
    LightKeys(const Session& session, SceneView& picture, ShownLights& lights, Editing& editing,
              Feedback& feedback);

    /// Does an action from AddLight to LightStrength.
    void perform(Action action, int argument);

private:
    void add(int what);

    const Session& session_;
    SceneView& picture_;
    ShownLights& lights_;
    Editing& editing_;
    Feedback& feedback_;
};

} // namespace relume
