#pragma once

#include <string>
#include <vector>

#include "assets/foreign/foreign_import.h"
#include "assets/gltf/gltf.h"
#include "assets/gltf/edit/gltf_edit.h"

namespace relume {

/// Reads a scene from a file of any kind: glTF by loadGltf(), others (see isForeign) converted by
/// importForeign() first. Messages and Scene::path have the name of the file itself. Throws Error.
Scene loadScene(const std::string& path, const GltfChoice& choice = {});

/// Reads the scene of a file that importForeign() has converted, as loadScene() does.
Scene loadImported(const std::string& path, const ImportedFile& file, const GltfChoice& choice = {});

/// Returns the files beside a scene of any kind that belong to it: of a glTF file what linkedFiles() returns,
/// of others what namedFiles() does. There are none where it cannot be read.
std::vector<std::string> filesOfScene(const std::string& path);

/// Saves edits as saveEditedGltf() does, into a .glb where the source is no glTF file. Such a source is
/// converted anew, and never written.
EditedNodes saveEditedScene(const std::string& source, const Scene& before, const Scene& after,
                            const std::string& target);

/// Throws Error where edits of this source cannot be saved as `target`, because one of the two is no glTF
/// file.
void requireSavable(const std::string& source, const std::string& target);

} // namespace relume
