#pragma once

#include "app/export/web/web_container.h"
#include "assets/atlas/world_mesh.h"
#include "assets/images/layered_exr.h"
#include "assets/model/scene.h"

namespace relume {

/// Adds what is drawn of a scene: its triangles, materials, textures, cameras and sky, and which of the
/// layers show how bright what shines looks. Textures become WebP without loss. A scene without a camera gets
/// the one that the viewer begins with. Throws Error.
void addScene(WebContainer& to, const Scene& scene, const WorldMesh& mesh, const LayeredImage& image);

} // namespace relume
