#pragma once

#include "app/viewer/panels/panel.h"

namespace relume {

/// Draws the controls of what is seen of the scene and how.
void drawViewPanel(const PanelContext& context);

} // namespace relume
