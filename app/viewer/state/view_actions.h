#pragma once

#include <string>

#include "app/viewer/state/shortcuts.h"
#include "app/viewer/state/view_state.h"

namespace relume {

/// Changes how the scene is looked at, by an action from View to AutomaticExposure. `exposure` is that of the
/// last picture [EV]. Returns the line that the user is told, "" for none.
std::string changeView(ViewState& view, Action action, int argument, float exposure);

/// Tells whether the view shows the scene by its light, so that there can be other light to compare it with.
bool comparesLight(const ViewState& view);

} // namespace relume
