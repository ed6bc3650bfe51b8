#pragma once

#include <span>
#include <vector>

#include "assets/atlas/world_mesh.h"
#include "bake/base/retrace_types.h"

namespace relume {

/// Adds the box around these triangles, where they have one.
void addBox(const WorldMesh& mesh, std::span<const uint32_t> triangles, std::vector<shader::TraceBox>& boxes);

/// Returns the boxes that tell where objects were, or are: one around all where they are more than four, as
/// each is a test per ray.
std::vector<shader::TraceBox> fewBoxes(std::vector<shader::TraceBox> boxes);

} // namespace relume
