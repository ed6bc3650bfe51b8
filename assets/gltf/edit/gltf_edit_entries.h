#pragma once

#include <string>
#include <vector>

#include "assets/gltf/edit/gltf_edit_json.h"

namespace relume::gltf {

/// Edits an extension that keeps its lights in a list of the file, of which nodes name entries:
/// KHR_lights_punctual and EXT_lights_area. Nodes that share an entry share it until one of their lights is
/// edited.
class LightEntries {
public:
    /// Keeps its arguments, which must outlive it. What a node names beyond the list counts as nothing.
    LightEntries(FileEdit& edit, const char* extension);

    /// Tells whether a node has such a light.
    bool has(int node) const { return entryOf(node) >= 0; }
    /// Returns the entry of a node's light, or a copy of it where other nodes use it too.
    EditedJson& own(int node);
    /// Gives a node without such a light an entry of its own.
    void add(int node, EditedJson entry);
    /// Takes a node's light away, if it has one; its entry stays until dropUnused().
    void remove(int node);
    /// Drops the entries that no node uses any more; call it once all has moved.
    void dropUnused();

private:
    EditedJson* list() const;
    int entryOf(int node) const;

    FileEdit& edit_;
    const char* extension_;
    std::vector<int> users_;  // nodes that use each entry
    std::vector<int> unused_; // entries that lost a user
};

} // namespace relume::gltf
