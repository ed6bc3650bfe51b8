#pragma once

#include <cstdint>
#include <optional>
#include <utility>

#include "assets/atlas/world_mesh.h"
#include "assets/model/scene.h"

namespace relume {

/// Returns the material with the largest area that is not black, which would stay black, or nothing where
/// there is none but glTF's default one.
std::optional<uint32_t> largestMaterial(const WorldMesh& mesh, const Scene& scene);

/// Returns the object whose number of triangles is nearest to a hundredth of all, and its share, or nothing
/// where there is only one object.
std::optional<std::pair<uint32_t, double>> smallObject(const WorldMesh& mesh, const Scene& scene);

} // namespace relume
