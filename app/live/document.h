#pragma once

#include "assets/model/scene_edits.h"
#include "bake/baker/baker.h"
#include "bake/lights/light_source.h"

namespace relume {

/// All that a user edits and that undo restores.
struct Document {
    SceneEdits edits; // of the scene
    LightMix mix;
    BakeSettings bake;
    LightmapDesc lightmap; // of exports
};

} // namespace relume
