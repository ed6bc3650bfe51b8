#include "assets/gltf/edit/gltf_edit_node.h"

#include "assets/base/error.h"
#include "assets/base/warnings.h"
#include "assets/gltf/edit/gltf_edit_transform.h"
#include "assets/gltf/gltf_node.h"
#include "assets/gltf/file/gltf_value.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace relume::gltf {

namespace {

using nlohmann::json;

/// Returns the members of a node that are what it carries: one, or several that belong together.
std::vector<JsonPath> membersOf(Carried carried) {
    switch (carried) {
    case Carried::Instance:
        return {{"mesh"},
                {"skin"},
                {"weights"},
                {"extensions", "EXT_mesh_gpu_instancing"},
                {"extras", "relume", "density"},
                {"extras", "relume", "hiddenCopies"}};
    case Carried::Light:
        return {{"extensions", kPunctualLights}};
    case Carried::AreaLight:
        return {{"extras", "relume", "areaLight"}, {"extensions", kAreaLights}};
    }
    return {};
}

/// Tells whether two things go to the same place. Only place and direction of a light count: its transform
/// need not have the scale of the node.
bool together(const Move& a, const Move& b) {
    if (a.to == b.to) return true;
    constexpr double kNear = 1e-6; // relative, of floats that went through a few products
    const glm::dvec3 difference = glm::dvec3(a.to[3]) - glm::dvec3(b.to[3]);
    if (glm::length(difference) > kNear * glm::length(glm::dvec3(a.to[3]))) return false;
    const glm::dmat3 from = frame(glm::dmat3(glm::mat3(a.to))), to = frame(glm::dmat3(glm::mat3(b.to)));
    return glm::length(from[0] - to[0]) <= kNear && glm::length(from[2] - to[2]) <= kNear;
}

/// Tells whether all that a node carries moves, and to the same place, so that the node itself can move.
bool movesWhole(EditedJson& node, const std::map<Carried, Move>& moves) {
    if (node.contains("camera")) return false;
    if (const EditedJson* children = find(node, {"children"}); children && !children->empty()) return false;
    for (const Carried carried : {Carried::Instance, Carried::Light, Carried::AreaLight})
        if (carries(node, carried) && !moves.contains(carried)) return false;
    return std::all_of(moves.begin(), moves.end(), [&](const auto& move) {
        return !move.second.apart && together(move.second, moves.begin()->second);
    });
}

/// Calls `visit` with the target of each animation channel that has one.
template<typename Json, typename Visit>
void eachTarget(Json& root, Visit visit) {
    const auto animations = root.find("animations");
    if (animations == root.end() || !animations->is_array()) return;
    for (auto& animation : *animations) {
        if (!animation.is_object() || !animation.contains("channels")) continue;
        for (auto& channel : animation["channels"])
            if (channel.is_object() && channel.contains("target") && channel["target"].is_object() &&
                channel["target"].contains("node"))
                visit(channel["target"]);
    }
}

bool isAnimated(FileEdit& edit, int node) {
    bool found = edit.hasPointers;
    eachTarget(edit.json, [&](EditedJson& target) {
        found = found || (target["node"] == node && target.value("path", "") != "weights");
    });
    return found;
}

/// Tells whether a node keeps its scale when it moves. A light's does, since a light has no size; that of an
/// area light does unless its parent is scaled unevenly, which a rectangle's corners show.
bool isRigid(Carried carried, const glm::dmat4& parent) {
    if (carried == Carried::Light) return true;
    if (carried == Carried::Instance) return false;
    const glm::dmat3 linear(parent);
    const glm::dmat3 square = glm::transpose(linear) * linear;
    double difference = 0.0;
    for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 3; ++r)
            difference = std::max(difference, std::abs(square[c][r] - (c == r ? square[0][0] : 0.0)));
    return difference <= 1e-6 * square[0][0];
}

void requireInvertible(const FileEdit& edit, const glm::dmat4& transform, const Move& move) {
    if (!invertible(transform))
        throw Error(fmt::format("{}: {} cannot be moved, as a node above it has a scale of 0: give that "
                                "node a scale or take it out of there",
                                edit.file.path, inQuotes(move.name)));
}

/// Describes a thing that leaves its node for a new child, and the place that this child gets among the
/// node's children.
struct Leaving {
    int node;
    Carried carried;
    size_t place;
};

int moveToChild(FileEdit& edit, const NodeTree& tree, const Leaving& leaving, const Move& move) {
    const int index = leaving.node;
    const Carried carried = leaving.carried;
    const glm::dmat4 world = tree.world(index);
    requireInvertible(edit, world, move);
    const int child = addNode(edit, move.name, index, leaving.place);
    EditedJson& nodes = edit.json["nodes"];
    EditedJson &from = nodes[static_cast<size_t>(index)], &to = nodes[static_cast<size_t>(child)];
    // The child comes from where the node is, as though it had been there all along.
    TransformEdit transform{world, glm::mat4(world), move.to, isRigid(carried, world), true};
    if (!editTransform(to, json::object(), transform)) edit.fail(fmt::format("nodes[{}]", index));
    for (const JsonPath& path : membersOf(carried)) {
        const EditedJson* member = find(from, path);
        if (!member) continue;
        EditedJson value = *member;
        erase(from, path);
        make(edit, to, path, "") = std::move(value);
    }
    if (carried == Carried::Instance) // morph targets are animated where the mesh is
        eachTarget(edit.json, [&](EditedJson& target) {
            if (target["node"] == index && target.value("path", "") == "weights") target["node"] = child;
        });
    return child;
}

/// Returns all that has to go to children of a node where these moves are made by children. A node's light of
/// KHR_lights_punctual comes before its area light; so the area light follows it into a child and stays where
/// it stands, or it would come first.
std::map<Carried, Move> withFollower(EditedJson& node, const glm::mat4& world,
                                     std::map<Carried, Move> moves) {
    if (moves.contains(Carried::Light) && !moves.contains(Carried::AreaLight) &&
        carries(node, Carried::AreaLight))
        moves[Carried::AreaLight] = {node.value("name", ""), world, world};
    return moves;
}

/// Tells whether a node may be named by a number that nothing here knows of.
bool hasUnknownExtensions(const FileEdit& edit) {
    constexpr std::array kNamesNoNode = {"KHR_materials_",      "KHR_texture_", "KHR_mesh_", "KHR_draco_",
                                         "KHR_lights_punctual", "EXT_texture_", kAreaLights, kVisibility};
    const auto used = edit.file.json.find("extensionsUsed");
    if (used == edit.file.json.end()) return false;
    return std::any_of(used->begin(), used->end(), [&](const json& entry) {
        const std::string& name = entry.get_ref<const std::string&>();
        return std::none_of(kNamesNoNode.begin(), kNamesNoNode.end(),
                            [&](const char* start) { return name.rfind(start, 0) == 0; });
    });
}

bool isSkinned(const FileEdit& edit, int node) {
    const auto skins = edit.file.json.find("skins");
    if (skins == edit.file.json.end()) return false;
    return std::any_of(skins->begin(), skins->end(), [&](const json& skin) {
        if (!skin.is_object()) return true;
        const auto joints = skin.find("joints");
        return (skin.contains("skeleton") && skin["skeleton"] == node) ||
               (joints != skin.end() && std::find(joints->begin(), joints->end(), node) != joints->end());
    });
}

/// Takes a node's number out of a holder's list, and the list where it is empty then.
void unlist(EditedJson& holder, const char* key, int node) {
    EditedJson* list = find(holder, {key});
    if (!list) return;
    for (size_t i = list->size(); i-- > 0;)
        if ((*list)[i] == node) list->erase(i);
    if (list->empty()) erase(holder, {key});
}

} // namespace

bool carries(EditedJson& node, Carried carried) {
    switch (carried) {
    case Carried::Instance:
        return find(node, {"mesh"});
    case Carried::Light:
        return find(node, {"extensions", kPunctualLights});
    case Carried::AreaLight:
        return find(node, {"extras", "relume", "areaLight"}) || find(node, {"extensions", kAreaLights});
    }
    return false;
}

NodeTree::NodeTree(const File& file, int scene) : file_(file) {
    const json none = json::array();
    const auto section = [&](const char* key) -> const json& {
        const auto found = file.json.find(key);
        return found == file.json.end() ? none : *found;
    };
    const json& nodes = section("nodes");
    parents_ = parentsOf(nodes);
    roots_.assign(nodes.size(), false);
    for (const int root : rootNodes(nodes, section("scenes"), scene))
        roots_[static_cast<size_t>(root)] = true;
}

const json& NodeTree::node(int index) const {
    return file_.json["nodes"][static_cast<size_t>(index)];
}

int NodeTree::root(int index) const {
    while (parents_[static_cast<size_t>(index)] >= 0)
        index = parents_[static_cast<size_t>(index)];
    return index;
}

bool NodeTree::inScene(int index) const {
    while (index >= 0 && !roots_[static_cast<size_t>(index)])
        index = parents_[static_cast<size_t>(index)];
    return index >= 0;
}

bool NodeTree::isVisible(int index) const {
    for (; index >= 0; index = parent(index))
        if (!gltf::isVisible(node(index))) return false;
    return true;
}

glm::dmat4 NodeTree::world(int index) const {
    return parentWorld(index) * localTransform(node(index));
}

glm::dmat4 NodeTree::parentWorld(int index) const {
    // This multiplies from the root down, in the importer's order: the same roundings give the same
    // transform.
    std::vector<int> chain;
    while ((index = parents_[static_cast<size_t>(index)]) >= 0)
        chain.push_back(index);
    glm::dmat4 world(1.0);
    for (auto link = chain.rbegin(); link != chain.rend(); ++link)
        world = world * localTransform(node(*link));
    return world;
}

int addNode(FileEdit& edit, const std::string& name, int parent, size_t place) {
    EditedJson& nodes = edit.json["nodes"];
    if (nodes.is_null()) nodes = EditedJson::array();
    const int index = static_cast<int>(nodes.size());
    EditedJson node = EditedJson::object();
    if (!name.empty()) node["name"] = name;
    nodes.push_back(std::move(node));
    // Without scenes all nodes that have no parent are shown.
    const bool hasScenes = edit.json.contains("scenes") && !edit.json["scenes"].empty();
    if (parent < 0 && !hasScenes) return index;
    EditedJson& holder = parent < 0 ? editedScene(edit) : nodes[static_cast<size_t>(parent)];
    EditedJson& list = holder[parent < 0 ? "nodes" : "children"];
    if (list.is_null()) list = EditedJson::array();
    list.insert(list.begin() + static_cast<std::ptrdiff_t>(std::min(place, list.size())), index);
    return index;
}

std::map<std::pair<int, Carried>, int> moveCarried(FileEdit& edit, const NodeTree& tree, const Moves& moves) {
    std::map<std::pair<int, Carried>, int> children;
    for (const auto& [index, carried] : moves) {
        EditedJson& node = edit.json["nodes"][static_cast<size_t>(index)];
        const auto& [first, move] = *carried.begin();
        if (movesWhole(node, carried)) {
            const glm::dmat4 parent = tree.parentWorld(index);
            requireInvertible(edit, parent, move);
            TransformEdit transform{parent, move.from, move.to, isRigid(first, parent), true};
            transform.mayBeMatrix = !isAnimated(edit, index);
            if (editTransform(node, tree.node(index), transform)) continue;
        }
        const glm::mat4 world(tree.world(index));
        size_t place = 0;
        for (const auto& [what, single] : withFollower(node, world, carried))
            children[{index, what}] = moveToChild(edit, tree, {index, what, place++}, single);
    }
    return children;
}

bool carriesNothing(const EditedJson& node) {
    constexpr std::array kOfItself = {"name", "translation", "rotation", "scale", "matrix"};
    return std::all_of(node.items().begin(), node.items().end(), [&](const auto& item) {
        return std::find(kOfItself.begin(), kOfItself.end(), item.key()) != kOfItself.end();
    });
}

void dropEmptyNodes(FileEdit& edit, std::vector<int> candidates) {
    if (candidates.empty() || hasUnknownExtensions(edit) || edit.hasPointers) return;
    std::sort(candidates.begin(), candidates.end());
    EditedJson& nodes = edit.json["nodes"];
    for (; !candidates.empty() && nodes.size() > 1; candidates.pop_back()) {
        const int last = static_cast<int>(nodes.size()) - 1;
        if (candidates.back() != last || !carriesNothing(nodes.back())) return;
        bool named = isSkinned(edit, last);
        eachTarget(edit.json, [&](EditedJson& target) { named = named || target["node"] == last; });
        if (named) return;
        for (EditedJson& node : nodes)
            unlist(node, "children", last);
        if (EditedJson* scenes = find(edit.json, {"scenes"}))
            for (EditedJson& scene : *scenes)
                unlist(scene, "nodes", last);
        nodes.erase(nodes.size() - 1);
    }
}

EditedJson& editedScene(FileEdit& edit) {
    if (!edit.json.contains("scenes") || edit.json["scenes"].empty()) {
        EditedJson scene = EditedJson::object();
        const json none = json::array();
        const std::vector<int> roots = rootNodes(edit.file.json.value("nodes", none), none, 0);
        if (!roots.empty()) scene["nodes"] = roots;
        edit.json["scene"] = 0;
        edit.json["scenes"] = EditedJson::array({std::move(scene)});
    }
    return edit.json["scenes"][static_cast<size_t>(edit.scene)];
}

} // namespace relume::gltf
