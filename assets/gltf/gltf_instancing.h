#pragma once

#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "assets/gltf/gltf_build.h"

namespace relume::gltf {

/// Returns the transforms to the node of the copies that EXT_mesh_gpu_instancing makes of a node's mesh; none
/// where the node does not use it. Translations and scales are three numbers, rotations four, each of them
/// floats or normalized integers. What does not fit is left out with a warning that names `where`.
std::vector<glm::dmat4> copiesOf(Build& build, const nlohmann::json& node, const std::string& where);

} // namespace relume::gltf
