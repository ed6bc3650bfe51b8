#pragma once

#include "app/viewer/panels/panel.h"

namespace relume {

/// What is seen of the scene and how.
void drawViewPanel(const PanelContext& context);

} // namespace relume
