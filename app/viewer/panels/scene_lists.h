#pragma once

#include <string>

#include "app/viewer/panels/panel.h"

namespace relume {

void drawCameras(const PanelContext& context, const LoadedScene& scene); // and bookmarks
void drawInstances(const PanelContext& context, const LoadedScene& scene);

} // namespace relume
