#pragma once

#include <string>

#include "assets/scene.h"

namespace relume {

/// Reads a .gltf or .glb file. What it cannot use goes to Scene::warnings. Throws Error naming file, thing
/// and mend.
Scene loadGltf(const std::string& path);

/// Writes a scene as one binary .glb: meshes shared by instances, one node per instance, materials, textures
/// (PNG), cameras, lights (KHR_lights_punctual), emission above 1 by KHR_materials_emissive_strength.
/// Temporary name, then rename. Loading the result gives the same scene. Throws Error.
void saveGlb(const Scene& scene, const std::string& path);

} // namespace relume
