#pragma once

#include "app/viewer/panels/panel.h"

namespace relume {

/// What was logged, the newest line last.
void drawLogPanel(const PanelContext& context);

} // namespace relume
