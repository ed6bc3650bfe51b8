#pragma once

#include "app/offline/bake_options.h"
#include "assets/model/scene_edits.h"

namespace relume {

/// Bakes the scene of options.files as edited into its output; with layers it does so light by light, in one
/// .exr. The atlas is that of the scene as its file has it, as in the viewer. Throws Error.
void bakeEdited(const BakeOptions& options, const SceneEdits& edits);

} // namespace relume
