#pragma once

#include "app/viewer/panels/panel.h"

namespace relume {

/// Draws what was logged, the newest line last.
void drawLogPanel(const PanelContext& context);

} // namespace relume
