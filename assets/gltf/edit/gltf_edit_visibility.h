#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "assets/gltf/edit/gltf_edit_node.h"
#include "assets/model/scene.h"

namespace relume::gltf {

/// Writes which objects are hidden, by KHR_node_visibility. A node hides all that it carries and all below
/// it; so what is hidden alone leaves such a node for a child, and what stays hidden when a node above is
/// shown again is hidden by nodes further down.
class VisibilityEdit {
public:
    VisibilityEdit(FileEdit& edit, const NodeTree& tree) : edit_(edit), tree_(tree) {}

    /// Shows what is no longer hidden and finds what is to be hidden; what has to leave its node is added to
    /// `moves`. Call it once lights are edited. The copies that a node makes of its mesh are hidden by it
    /// where all are; one alone is for editCopies().
    void apply(const Scene& before, const Scene& after, Moves& moves);

    /// Hides what is to be hidden, once all has moved to these children.
    void finish(const std::map<std::pair<int, Carried>, int>& children);

private:
    EditedJson& node(int index) const { return edit_.json["nodes"][static_cast<size_t>(index)]; }
    void setVisible(int index, bool visible);
    void show(int index, Moves& moves);
    void hide(int index, Carried carried, Moves& moves);

    FileEdit& edit_;
    const NodeTree& tree_;
    std::map<int, bool> hidden_; // of the nodes of instances: whether all is to be
    std::vector<std::pair<int, Carried>> pending_;
    bool changed_ = false;
};

} // namespace relume::gltf
