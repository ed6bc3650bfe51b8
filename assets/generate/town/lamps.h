#pragma once

#include "assets/generate/town/kit.h"

namespace relume::generate {

/// Adds sun, sky and the twenty lamps with what they hang on; rooms.h says where those inside are.
void addTownLights(TownKit& kit);

/// Adds the cameras, the one that shows the town best first.
void addTownCameras(SceneBuilder& builder);

} // namespace relume::generate
