#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include <glm/glm.hpp>

#include "assets/gltf/edit/gltf_edit_json.h"

namespace relume::gltf {

/// Names what a node may carry and an edit may move.
enum class Carried { Instance, Light, AreaLight };

struct Move {
    std::string name;     // of what moves, for a node of its own
    glm::mat4 from{1.0f}; // to world, as the scene had it
    glm::mat4 to{1.0f};
    bool apart =
        false; // it goes to a child in any case, since what else its node carries is to differ from it
};

/// Holds moves by node and by what it carries.
using Moves = std::map<int, std::map<Carried, Move>>;

/// Tells where the nodes of a file are. It is made from the file as it was: an edit moves no node that has
/// children.
class NodeTree {
public:
    NodeTree(const File& file, int scene); // `file` must outlive it

    size_t size() const { return parents_.size(); }
    const nlohmann::json& node(int index) const;
    /// Tells whether a node is in the scene, or, where there are no scenes, whether it is a node at
    /// all.
    bool inScene(int index) const;
    /// Returns a node's parent, or -1.
    int parent(int index) const { return parents_[static_cast<size_t>(index)]; }
    /// Tells whether a node and all above it are visible.
    bool isVisible(int index) const;
    /// Returns the node at the top of the tree that a node is in.
    int root(int index) const;
    glm::dmat4 world(int index) const;
    /// Returns the world transform of a node's parent.
    glm::dmat4 parentWorld(int index) const;

private:
    const File& file_;
    std::vector<int> parents_; // -1: none
    std::vector<bool> roots_;  // of the scene
};

constexpr size_t kLastPlace = static_cast<size_t>(-1);

/// Adds a node of this name and returns its index; it is a child of `parent` or, at -1, a root of the edited
/// scene. `place` is its place among these, as far as the file has a list of them.
int addNode(FileEdit& edit, const std::string& name, int parent, size_t place = kLastPlace);

/// Moves what nodes carry: each thing by its node where nothing else would move along, else by a new child of
/// the node, which carries it from now on. Returns those children by what they carry. A scene is read from
/// each node down, children in their order, and users tell things of one name apart by that; so such a child
/// is the first of its node, and objects and lights keep their order. Throws Error.
std::map<std::pair<int, Carried>, int> moveCarried(FileEdit& edit, const NodeTree& tree, const Moves& moves);

/// Takes away the last nodes of the file as far as they are among `candidates`, carry nothing and are named
/// by nothing but their parent and scenes: adding and deleting a light leaves no trace.
void dropEmptyNodes(FileEdit& edit, std::vector<int> candidates);

/// Tells whether a node carries a mesh, or a light of that kind.
bool carries(EditedJson& node, Carried carried);

/// Tells whether a node carries nothing at all, not even children.
bool carriesNothing(const EditedJson& node);

/// Returns the scene that is edited, which is made where the file has no scene.
EditedJson& editedScene(FileEdit& edit);

} // namespace relume::gltf
