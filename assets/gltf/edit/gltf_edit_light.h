#pragma once

#include <vector>

#include "assets/gltf/edit/gltf_edit_entries.h"
#include "assets/gltf/edit/gltf_edit_node.h"
#include "assets/model/scene.h"

namespace relume::gltf {

/// Edits a file's lights, except that those that stay are not moved yet.
class LightEdit {
public:
    /// Keeps its arguments, which must all outlive it. `target` is named in messages.
    LightEdit(FileEdit& edit, const NodeTree& tree, const std::string& target);

    /// Writes what differs; what has to move is added to `moves`. Returns the node of each light of `after`.
    std::vector<int> apply(const std::vector<Light>& before, const std::vector<Light>& after, Moves& moves);

    /// Drops the entries of lights that no node uses any more; call it once all has moved.
    void dropUnused() {
        punctual_.dropUnused();
        area_.dropUnused();
    }
    /// Returns the nodes whose light was deleted.
    const std::vector<int>& emptied() const { return emptied_; }

private:
    int adopt(const Light& light, size_t rootPlace, Moves& moves);
    size_t rootPlace(const std::vector<int>& nodes, size_t index) const;
    void remove(const Light& light);
    void write(int node, const Light& light, const Light* before);
    void writePunctual(EditedJson& entry, const Light& light, const Light* before) const;
    void writeArea(int node, const Light& light, const Light* before);
    void writeAreaExtension(EditedJson& entry, const Light& light, double scale) const;
    void requireGood(const Light& light) const;
    bool holds(int node, bool area) const;
    bool hasAreaExtras(int node) const;

    FileEdit& edit_;
    const NodeTree& tree_;
    const std::string& target_;
    LightEntries punctual_, area_;
    std::vector<int> emptied_; // nodes
};

} // namespace relume::gltf
