#include "assets/gltf/edit/gltf_edit_visibility.h"

#include "assets/gltf/file/gltf_value.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

namespace relume::gltf {

namespace {

/// Returns for each node with objects whether all of them are hidden.
std::map<int, bool> hiddenNodes(const Scene& scene) {
    std::map<int, bool> hidden;
    for (const Instance& instance : scene.instances) {
        const auto [place, isNew] = hidden.emplace(instance.node, instance.hidden);
        place->second = place->second && instance.hidden;
    }
    return hidden;
}

/// Tells whether hiding a node would hide more than its object.
bool hidesMore(EditedJson& node) {
    const EditedJson* children = find(node, {"children"});
    return (children && !children->empty()) || carries(node, Carried::Light) ||
           carries(node, Carried::AreaLight);
}

} // namespace

void VisibilityEdit::setVisible(int index, bool visible) {
    const JsonPath path = {"extensions", kVisibility, "visible"};
    if (visible)
        erase(node(index), path);
    else
        make(edit_, node(index), path, fmt::format("nodes[{}]", index)) = false;
    changed_ = true;
}

void VisibilityEdit::apply(const Scene& before, const Scene& after, Moves& moves) {
    std::map<int, bool> known = hiddenNodes(before);
    hidden_ = hiddenNodes(after);
    std::vector<int> changed; // in the order of the scene
    for (const Instance& instance : after.instances)
        if (bool& was = known[instance.node]; was != hidden_[instance.node]) {
            changed.push_back(instance.node);
            was = !was;
        }
    for (const int index : changed)
        if (!hidden_[index]) show(index, moves);
    for (const int index : changed)
        if (hidden_[index]) hide(index, Carried::Instance, moves);
}

/// Makes a node visible, and all above it; what else these nodes have hidden stays hidden.
void VisibilityEdit::show(int index, Moves& moves) {
    std::vector<int> chain;
    for (int i = index; i >= 0; i = tree_.parent(i))
        chain.insert(chain.begin(), i);
    bool wasHidden = false; // by a node so far
    for (size_t i = 0; i < chain.size(); ++i) {
        const EditedJson* visible = find(node(chain[i]), {"extensions", kVisibility, "visible"});
        if (visible && *visible == false) {
            setVisible(chain[i], true);
            wasHidden = true;
        }
        if (!wasHidden) continue;
        const int next = i + 1 < chain.size() ? chain[i + 1] : -1;
        if (const EditedJson* children = find(node(chain[i]), {"children"}))
            for (const int child : children->get<std::vector<int>>())
                if (child != next) setVisible(child, false);
        for (const Carried carried : {Carried::Instance, Carried::Light, Carried::AreaLight}) {
            const bool stays = carried == Carried::Instance && !hidden_[chain[i]];
            if (carries(node(chain[i]), carried) && !stays) hide(chain[i], carried, moves);
        }
    }
}

/// Notes that a thing is to be hidden, by itself where its node has more to show.
void VisibilityEdit::hide(int index, Carried carried, Moves& moves) {
    pending_.emplace_back(index, carried);
    if (carried == Carried::Instance && !hidesMore(node(index))) return;
    const glm::mat4 world(tree_.world(index));
    const auto [move, isNew] =
        moves[index].try_emplace(carried, Move{textOr(tree_.node(index), "name", ""), world, world, true});
    move->second.apart = true;
}

void VisibilityEdit::finish(const std::map<std::pair<int, Carried>, int>& children) {
    for (const auto& thing : pending_) {
        const auto child = children.find(thing);
        setVisible(child == children.end() ? thing.first : child->second, false);
    }
    if (!changed_) return;
    const EditedJson& nodes = edit_.json["nodes"];
    const bool used = std::any_of(nodes.begin(), nodes.end(), [](const EditedJson& value) {
        return value.contains("extensions") && value["extensions"].contains(kVisibility);
    });
    if (used)
        useExtension(edit_, kVisibility);
    else
        dropExtension(edit_, kVisibility);
}

} // namespace relume::gltf
