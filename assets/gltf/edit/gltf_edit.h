#pragma once

#include <string>
#include <vector>

#include "assets/model/scene.h"

namespace relume {

/// Tells where the lights and instances of `after` are in the written file: at these nodes, which `after`
/// needs to be the `before` of the next edit.
struct EditedNodes {
    std::vector<int> lights, instances;
};

/// Writes the file `source` again as `target` with what differs between `before` (the scene as
/// loadGltf(source) gave it) and `after` (the same scene, edited): lights moved, changed, added (Light::node
/// -1) and deleted; the sky; emission and base colour of materials; transforms of instances, and which are
/// hidden. All else in the file stays to the byte, its layout and the spelling of its numbers too; `target`
/// may be `source`.
///
/// Lights and the sky are in the file as README.md says. Sky::file is a path that can be opened; the file has
/// it relative to its own folder.
///
/// Nodes keep their numbers. A node is moved itself where it carries nothing but what moves; else what moves
/// becomes a new child of it. A deleted light's node stays, unless it is empty and the last of the file. A
/// light that several nodes share is copied for the one that changes. Where `target` is in another folder,
/// relative URIs are written anew so that they lead to the same files.
///
/// The file is written by a temporary name and then renamed. Throws Error, and leaves `target` as it was,
/// where the source is no good file, is not the one that `before` came from, is a .glb and `target` a .gltf
/// or the other way round, or where an edited value is not finite or out of glTF's range.
///
/// Nothing but materials, instances, lights, sky and path of the two scenes is looked at: partsOfEdits will
/// do.
EditedNodes saveEditedGltf(const std::string& source, const Scene& before, const Scene& after,
                           const std::string& target);

/// Returns a copy of what saveEditedGltf looks at, without meshes, textures and pixels.
Scene partsOfEdits(const Scene& scene);

} // namespace relume
