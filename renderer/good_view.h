#pragma once

#include "assets/atlas/world_mesh.h"
#include "renderer/camera.h"

namespace relume {

/// A camera for a scene that brings none. Where its middle is a room, closed but for some openings, it stands
/// inside, in the corner from where most is seen; otherwise outside, where all is seen.
ViewCamera goodView(const WorldMesh& mesh, float aspect);

} // namespace relume
