#pragma once

#include <vector>

#include "assets/atlas/world_mesh.h"
#include "assets/model/scene.h"

namespace relume {

/// Light for a level whose file has none.
struct PreviewLight {
    std::vector<Light> lights; // marked as a preview
    SkySettings sky;           // likewise; dark in a closed interior
    bool closed = false;       // a lamp for a closed interior, else daylight
};

/// Tells whether nothing in the scene shines: no light, no sky, and no visible surface.
bool isDark(const Scene& scene);

/// Returns a sun with a soft disc and a sky of a clear afternoon; for an interior into which no sky is seen a
/// lamp at the point of greatest clearance, which is as bright as a living room asks for. Throws Error.
PreviewLight previewLight(const WorldMesh& mesh);

/// Adds the preview light to a scene that is dark. Returns what was added, in words ("a preview sun and sky"),
/// "" where the scene has light of its own. Throws Error.
std::string addPreviewLight(Scene& scene, const WorldMesh& mesh);

} // namespace relume
