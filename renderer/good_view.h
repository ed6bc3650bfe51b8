#pragma once

#include "assets/atlas/world_mesh.h"
#include "renderer/camera.h"

namespace relume {

/// Returns a camera for a scene that brings none. Where the scene's middle is a room, closed but for some
/// openings, the camera stands inside, in the corner from where most is seen; in the streets of a town it
/// stands on the ground; otherwise it stands outside, where all is seen.
ViewCamera goodView(const WorldMesh& mesh, float aspect);

} // namespace relume
