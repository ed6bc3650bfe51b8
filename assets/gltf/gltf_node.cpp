#include "assets/gltf/gltf_build.h"

#include "assets/gltf/gltf_node.h"
#include "assets/base/error.h"
#include "assets/gltf/gltf_file.h"
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

Camera makeCamera(const tinygltf::Camera& source, const std::string& name, const glm::mat4& transform) {
    Camera camera;
    camera.name = source.name.empty() ? name : source.name;
    camera.transform = transform;
    camera.perspective = source.type != "orthographic";
    if (camera.perspective) {
        camera.yfov = static_cast<float>(source.perspective.yfov);
        camera.aspect = static_cast<float>(source.perspective.aspectRatio);
        camera.znear = static_cast<float>(source.perspective.znear);
        camera.zfar = static_cast<float>(source.perspective.zfar);
    } else {
        camera.ymag = static_cast<float>(source.orthographic.ymag);
        if (source.orthographic.ymag != 0.0)
            camera.aspect = static_cast<float>(source.orthographic.xmag / source.orthographic.ymag);
        camera.znear = static_cast<float>(source.orthographic.znear);
        camera.zfar = static_cast<float>(source.orthographic.zfar);
    }
    return camera;
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

void addNode(Build& build, size_t index, const glm::mat4& world) {
    const json& node = build.nodes[index];
    if (!finite(world)) {
        build.warnings.add(labelOf(node, index), "has a transform that is not finite and is ignored");
        return;
    }
    const int mesh = indexOr(node, "mesh", -1), camera = indexOr(node, "camera", -1);
    if (mesh >= 0 && !build.scene.meshes[static_cast<size_t>(mesh)].primitives.empty()) {
        Instance instance;
        instance.name = nameOf(node);
        if (instance.name.empty()) instance.name = build.scene.meshes[static_cast<size_t>(mesh)].name;
        instance.mesh = mesh;
        instance.transform = world;
        instance.density = densityOf(build, index);
        instance.node = static_cast<int>(index);
        build.scene.instances.push_back(std::move(instance));
    }
    if (camera >= 0)
        build.scene.cameras.push_back(
            makeCamera(build.model.cameras[static_cast<size_t>(camera)], nameOf(node), world));
    if (member(node, "skin"))
        build.warnings.add(labelOf(node, index), "skins are not supported, the rest pose is used");
    addLights(build, index, world);
    const json* extensions = member(node, "extensions");
    if (extensions && member(*extensions, "EXT_mesh_gpu_instancing"))
        build.warnings.add(labelOf(node, index),
                           "EXT_mesh_gpu_instancing is not supported, one instance is used");
}

} // namespace

glm::dmat4 localTransform(const json& node) {
    glm::dmat4 local(1.0);
    if (const json* matrix = member(node, "matrix")) {
        for (int i = 0; i < 16; ++i)
            local[i / 4][i % 4] = at(*matrix, i);
        // This is an affine transform's last row, which exporters round.
        for (int c = 0; c < 4; ++c)
            local[c][3] = c == 3 ? 1.0 : 0.0;
        return local;
    }
    if (const json* rotation = member(node, "rotation")) {
        const glm::dquat q(at(*rotation, 3), at(*rotation, 0), at(*rotation, 1), at(*rotation, 2));
        const double length = glm::length(q);
        if (length > 0.0) local = glm::mat4_cast(q / length);
    }
    if (const json* scale = member(node, "scale"))
        for (int c = 0; c < 3; ++c)
            local[c] *= at(*scale, c);
    if (const json* translation = member(node, "translation"))
        local[3] = glm::dvec4(at(*translation, 0), at(*translation, 1), at(*translation, 2), 1.0);
    return local;
}

std::vector<int> rootNodes(const json& nodes, const json& scenes, int defaultScene) {
    std::vector<int> roots;
    if (!scenes.empty()) {
        const json* listed = member(scenes[static_cast<size_t>(defaultScene)], "nodes");
        return listed ? listed->get<std::vector<int>>() : roots;
    }
    std::vector<bool> isChild(nodes.size());
    for (const json& node : nodes)
        if (const json* children = member(node, "children"))
            for (const json& child : *children)
                isChild[child.get<size_t>()] = true;
    for (size_t i = 0; i < isChild.size(); ++i)
        if (!isChild[i]) roots.push_back(static_cast<int>(i));
    return roots;
}

void buildNodes(Build& build) {
    struct Visit {
        int node;
        glm::dmat4 parent;
    };
    std::vector<Visit> stack;
    const std::vector<int> roots = rootNodes(build.nodes, build.scenes, build.defaultScene);
    std::vector<bool> visited(build.nodes.size());
    for (auto root = roots.rbegin(); root != roots.rend(); ++root)
        stack.push_back({*root, glm::dmat4(1.0)});
    while (!stack.empty()) {
        const Visit visit = stack.back();
        stack.pop_back();
        const size_t index = static_cast<size_t>(visit.node);
        if (visited[index]) continue; // a scene may list a root twice; the check excludes all else
        visited[index] = true;
        const json& node = build.nodes[index];
        const glm::dmat4 world = visit.parent * localTransform(node);
        addNode(build, index, glm::mat4(world));
        if (const json* children = member(node, "children"))
            for (auto child = children->rbegin(); child != children->rend(); ++child)
                stack.push_back({child->get<int>(), world});
    }
}

} // namespace relume::gltf
