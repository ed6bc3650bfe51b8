#pragma once

#include "app/viewer/panels/panel.h"

namespace relume {

/// Draws what frames and the bake cost.
void drawProfilerPanel(const PanelContext& context);

} // namespace relume
