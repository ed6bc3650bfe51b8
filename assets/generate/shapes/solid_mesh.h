#pragma once

#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "assets/generate/shapes/solid.h"
#include "assets/model/scene.h"

namespace relume::generate {

/// Tells what becomes of the charts' places: TEXCOORD_1, or nothing, as levels come from elsewhere.
enum class LightmapUvs { Places, None };

/// Makes the mesh of a solid, with a primitive for each material. `tiles` holds the size of a texture's tile
/// by material [m], 0 for a material without texture. Triangles of no area are left out. Coordinates are
/// snapped, and normals are smoothed where the surface bends by less than the crease angle.
Mesh meshOf(const std::string& name, const Solid& solid, const std::vector<glm::dvec2>& tiles,
            LightmapUvs uvs);

} // namespace relume::generate
