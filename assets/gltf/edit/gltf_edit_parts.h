#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "assets/gltf/edit/gltf_edit_json.h"
#include "assets/model/scene.h"

namespace relume::gltf {

/// Writes emission and base colour where they differ. Throws Error naming `target`, as all of these do.
void editMaterials(FileEdit& edit, const std::vector<Material>& before, const std::vector<Material>& after,
                   const std::string& target);

/// Writes the sky where it differs, and its file where `target` is in another folder.
void editSky(FileEdit& edit, const Sky& before, const Sky& after, const std::string& target);

/// Lets relative URIs lead from the folder of `target` to where they lead now.
void moveUris(FileEdit& edit, const std::string& target);

/// Returns a path as it is written in a file in another folder: relative, or absolute where that is
/// impossible.
std::string pathFrom(const std::filesystem::path& folder, const std::filesystem::path& path);

/// Returns the folder that a file is in, without links and "..".
std::filesystem::path folderOf(const std::string& path);

} // namespace relume::gltf
