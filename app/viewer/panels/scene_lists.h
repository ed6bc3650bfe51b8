#pragma once

#include <string>

#include "app/viewer/panels/panel.h"

namespace relume {

/// A name from a file, "material 3" where it has none.
std::string nameOf(const std::string& name, const char* kind, size_t index);

void drawCameras(const PanelContext& context, const LoadedScene& scene); // and bookmarks
void drawInstances(const PanelContext& context, const LoadedScene& scene);

} // namespace relume
