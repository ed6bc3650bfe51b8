#include "assets/gltf/gltf_build.h"

#include "assets/base/error.h"
#include "assets/base/warnings.h"
#include "assets/gltf/gltf_camera.h"
#include "assets/gltf/file/gltf_file.h"
#include "assets/gltf/gltf_instancing.h"
#include "assets/gltf/gltf_node.h"
#include "assets/gltf/file/gltf_value.h"
#include "assets/model/lightmap_pages.h"
#include "assets/model/scene_limits.h"

#include <glm/gtc/quaternion.hpp>
#include <spdlog/fmt/fmt.h>

#include <cmath>

namespace relume::gltf {

namespace {

using nlohmann::json;

/// Returns a node's member, or nullptr where it has none.
const json* member(const json& node, const char* key) {
    const auto found = node.find(key);
    return found == node.end() ? nullptr : &*found;
}

int indexOr(const json& node, const char* key, int fallback) {
    const json* value = member(node, key);
    return value ? value->get<int>() : fallback;
}

double at(const json& array, int i) {
    return array[static_cast<size_t>(i)].get<double>();
}

bool finite(const glm::mat4& m) {
    for (int c = 0; c < 4; ++c)
        for (int r = 0; r < 4; ++r)
            if (!std::isfinite(m[c][r])) return false;
    return true;
}

std::string nameOf(const json& node) {
    return node.value("name", "");
}

std::string labelOf(const json& node, size_t index) {
    const std::string name = nameOf(node);
    return name.empty() ? fmt::format("node {}", index) : "node " + inQuotes(name);
}

bool hasLight(const json& node) {
    return extensionOf(node, kPunctualLights) || extensionOf(node, kAreaLights) ||
           ownExtra(node, "areaLight");
}

/// Tells whether all nodes above one are visible, also those that are not in the scene.
bool visibleAbove(const json& nodes, const NodePlaces& places, int node) {
    for (int i = places.parent(static_cast<size_t>(node)); i >= 0; i = places.parent(static_cast<size_t>(i)))
        if (!isVisible(nodes[static_cast<size_t>(i)])) return false;
    return true;
}

/// Returns the factor on the texels per metre of a node's mesh; what is wrong with it is warned about.
float densityOf(Build& build, size_t index) {
    const json& node = build.nodes[index];
    const json* value = ownExtra(node, "density");
    if (!value) return 1.0f;
    const double density = value->is_number() ? value->get<double>() : 0.0;
    if (density >= kLeastDensity && density <= kMostDensity) return static_cast<float>(density);
    build.warnings.add(
        labelOf(node, index),
        fmt::format("its density is no number from {:g} to {:g}, 1 is used", kLeastDensity, kMostDensity));
    return 1.0f;
}

/// Returns the page of the lightmap for which a node's mesh has lightmap UVs; what is wrong with it is warned
/// about.
uint32_t pageOf(Build& build, size_t index) {
    const json& node = build.nodes[index];
    const json* value = ownExtra(node, "page");
    if (!value) return 0;
    const double page = value->is_number() ? value->get<double>() : -1.0;
    if (page >= 0.0 && page < build.scene.pages && page == std::floor(page))
        return static_cast<uint32_t>(page);
    build.warnings.add(labelOf(node, index),
                       fmt::format("its lightmap page is none of the {} that its scene tells of, page 0 is "
                                   "used",
                                   build.scene.pages));
    return 0;
}

/// Adds the objects of a node: one, or one for each copy that it makes of its mesh.
void addInstances(Build& build, size_t index, const glm::dmat4& world, bool visible) {
    const json& node = build.nodes[index];
    const auto bent = build.bentMeshes.find(index);
    Instance instance;
    instance.mesh = bent != build.bentMeshes.end() ? bent->second : indexOr(node, "mesh", -1);
    if (instance.mesh < 0 || build.scene.meshes[static_cast<size_t>(instance.mesh)].primitives.empty())
        return;
    instance.name = nameOf(node);
    if (instance.name.empty()) instance.name = build.scene.meshes[static_cast<size_t>(instance.mesh)].name;
    instance.node = static_cast<int>(index);
    instance.hidden = !visible;
    instance.density = densityOf(build, index);
    instance.page = pageOf(build, index);
    instance.bent = build.skinnedNodes.contains(index);
    instance.transform = instance.bent ? glm::mat4(1.0f) : glm::mat4(world);
    const std::vector<NodeCopy> copies = copiesOf(build, node, labelOf(node, index));
    if (copies.empty() || instance.bent) {
        if (instance.bent)
            build.warnings.add(labelOf(node, index),
                               build.choice.time ? "has a skin, which stands as its joints do at that time"
                                                 : "has a skin, which stands in its rest pose");
        build.scene.instances.push_back(std::move(instance));
        return;
    }
    const std::string name = instance.name;
    for (size_t i = 0; i < copies.size(); ++i) {
        instance.transform = glm::mat4(world * copies[i].transform);
        if (!finite(instance.transform)) {
            build.warnings.add(labelOf(node, index),
                               "has instances whose places are not finite, which are left out");
            continue;
        }
        instance.name = fmt::format("{} #{}", name, i + 1);
        instance.copy = static_cast<int>(i);
        instance.hidden = !visible || copies[i].hidden;
        build.scene.instances.push_back(instance);
    }
}

void addNode(Build& build, size_t index, const glm::dmat4& place, bool visible) {
    const json& node = build.nodes[index];
    const glm::mat4 world(place);
    if (!finite(world)) {
        build.warnings.add(labelOf(node, index), "has a transform that is not finite and is ignored");
        return;
    }
    addInstances(build, index, place, visible);
    const int camera = indexOr(node, "camera", -1);
    if (camera >= 0)
        build.scene.cameras.push_back(
            makeCamera(build.model.cameras[static_cast<size_t>(camera)], nameOf(node), world));
    if (visible)
        addLights(build, index, world);
    else if (hasLight(node))
        build.warnings.add(labelOf(node, index), "is hidden, its light is left out");
}

} // namespace

glm::dmat4 localTransform(const json& node, const NodePose* pose) {
    glm::dmat4 local(1.0);
    if (const json* matrix = member(node, "matrix")) { // animations leave such a node alone
        for (int i = 0; i < 16; ++i)
            local[i / 4][i % 4] = at(*matrix, i);
        // This is an affine transform's last row, which exporters round.
        for (int c = 0; c < 4; ++c)
            local[c][3] = c == 3 ? 1.0 : 0.0;
        return local;
    }
    const json *rotation = member(node, "rotation"), *scale = member(node, "scale"),
               *translation = member(node, "translation");
    glm::dquat q(1.0, 0.0, 0.0, 0.0);
    if (rotation) q = glm::dquat(at(*rotation, 3), at(*rotation, 0), at(*rotation, 1), at(*rotation, 2));
    if (pose && pose->rotation) q = *pose->rotation;
    const double length = glm::length(q);
    if (length > 0.0) local = glm::mat4_cast(q / length);
    if (scale || (pose && pose->scale))
        for (int c = 0; c < 3; ++c)
            local[c] *= pose && pose->scale ? (*pose->scale)[c] : at(*scale, c);
    if (pose && pose->translation)
        local[3] = glm::dvec4(*pose->translation, 1.0);
    else if (translation)
        local[3] = glm::dvec4(at(*translation, 0), at(*translation, 1), at(*translation, 2), 1.0);
    return local;
}

std::vector<int> parentsOf(const json& nodes, const std::function<void(size_t)>& twice) {
    std::vector<int> parents(nodes.size(), -1);
    for (size_t i = 0; i < nodes.size(); ++i) {
        const json* children = member(nodes[i], "children");
        if (!children) continue;
        for (const json& child : *children) {
            int& parent = parents[child.get<size_t>()];
            if (parent >= 0 && twice) twice(child.get<size_t>());
            parent = static_cast<int>(i);
        }
    }
    return parents;
}

std::vector<int> rootNodes(const json& nodes, const json& scenes, int scene) {
    const std::vector<int> parents = parentsOf(nodes);
    std::vector<int> roots;
    if (scenes.empty()) {
        for (size_t i = 0; i < parents.size(); ++i)
            if (parents[i] < 0) roots.push_back(static_cast<int>(i));
        return roots;
    }
    const json* listed = member(scenes[static_cast<size_t>(scene)], "nodes");
    if (!listed) return roots;
    enum class Above : uint8_t { Unknown, Nothing, Listed }; // what of the scene's list stands above a node
    std::vector<Above> above(parents.size(), Above::Unknown);
    std::vector<bool> isListed(parents.size());
    for (const json& root : *listed)
        isListed[root.get<size_t>()] = true;
    for (const json& root : *listed) {
        std::vector<size_t> way; // up to where it is known
        size_t node = root.get<size_t>();
        Above found = above[node];
        while (found == Above::Unknown) {
            way.push_back(node);
            if (parents[node] < 0) {
                found = Above::Nothing;
                break;
            }
            node = static_cast<size_t>(parents[node]);
            found = isListed[node] ? Above::Listed : above[node];
        }
        for (const size_t passed : way)
            above[passed] = found;
        if (above[root.get<size_t>()] == Above::Nothing) roots.push_back(root.get<int>());
    }
    return roots;
}

NodePlaces::NodePlaces(const json& nodes, const Poses& poses)
    : nodes_(nodes), poses_(poses), parents_(parentsOf(nodes)) {}

const NodePose* NodePlaces::pose(size_t node) const {
    const auto found = poses_.find(node);
    return found == poses_.end() ? nullptr : &found->second;
}

glm::dmat4 NodePlaces::local(size_t node) const {
    return localTransform(nodes_[node], pose(node));
}

glm::dmat4 NodePlaces::world(size_t node) {
    std::vector<size_t> way; // up to the first whose place is known
    int next = static_cast<int>(node);
    while (next >= 0 && !known_.contains(static_cast<size_t>(next)) && way.size() <= parents_.size()) {
        way.push_back(static_cast<size_t>(next));
        next = parents_[way.back()];
    }
    glm::dmat4 world = next >= 0 ? known_[static_cast<size_t>(next)] : glm::dmat4(1.0);
    for (auto below = way.rbegin(); below != way.rend(); ++below)
        known_[*below] = world = world * local(*below);
    return world;
}

glm::dmat4 NodePlaces::parentWorld(size_t node) {
    return parents_[node] < 0 ? glm::dmat4(1.0) : world(static_cast<size_t>(parents_[node]));
}

/// Notes how many pages the lightmap has for which the scene's lightmap UVs are meant.
void readPages(Build& build) {
    if (build.scenes.empty()) return; // a file may do without scenes
    const json* value = ownExtra(build.scenes[static_cast<size_t>(build.sceneNumber)], "pages");
    if (!value) return;
    const double pages = value->is_number() ? value->get<double>() : 0.0;
    if (pages >= 1.0 && pages <= kMostPages && pages == std::floor(pages))
        build.scene.pages = static_cast<uint32_t>(pages);
    else
        build.warnings.add(
            "scene", fmt::format("its number of lightmap pages is none from 1 to {}, 1 is used", kMostPages));
}

void buildNodes(Build& build, NodePlaces& places) {
    readPages(build);
    struct Visit {
        int node;
        glm::dmat4 parent;
        bool visible; // its parent
    };
    std::vector<Visit> stack;
    const std::vector<int> roots = rootNodes(build.nodes, build.scenes, build.sceneNumber);
    std::vector<bool> visited(build.nodes.size());
    for (auto root = roots.rbegin(); root != roots.rend(); ++root)
        stack.push_back({*root, places.parentWorld(static_cast<size_t>(*root)),
                         visibleAbove(build.nodes, places, *root)});
    while (!stack.empty()) {
        const Visit visit = stack.back();
        stack.pop_back();
        const size_t index = static_cast<size_t>(visit.node);
        if (visited[index]) continue; // a scene may list a root twice; the check excludes all else
        visited[index] = true;
        const json& node = build.nodes[index];
        const glm::dmat4 world = visit.parent * places.local(index);
        const bool visible = visit.visible && isVisible(node);
        addNode(build, index, world, visible);
        if (const json* children = member(node, "children"))
            for (auto child = children->rbegin(); child != children->rend(); ++child)
                stack.push_back({child->get<int>(), world, visible});
    }
}

} // namespace relume::gltf
