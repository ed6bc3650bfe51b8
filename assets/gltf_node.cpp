#include "assets/gltf_build.h"

#include "assets/error.h"

#include <glm/gtc/quaternion.hpp>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

namespace relume::gltf {

namespace {

constexpr double kHalfPi = 1.57079632679489662;

glm::dmat4 localTransform(const tinygltf::Node& node) {
    glm::dmat4 local(1.0);
    if (node.matrix.size() == 16) {
        for (int i = 0; i < 16; ++i)
            local[i / 4][i % 4] = node.matrix[static_cast<size_t>(i)];
        // An affine transform's last row; exporters round it.
        for (int c = 0; c < 4; ++c)
            local[c][3] = c == 3 ? 1.0 : 0.0;
        return local;
    }
    if (node.rotation.size() == 4) {
        const glm::dquat q(node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2]);
        const double length = glm::length(q);
        if (length > 0.0) local = glm::mat4_cast(q / length);
    }
    if (node.scale.size() == 3)
        for (int c = 0; c < 3; ++c)
            local[c] *= node.scale[static_cast<size_t>(c)];
    if (node.translation.size() == 3)
        local[3] = glm::dvec4(node.translation[0], node.translation[1], node.translation[2], 1.0);
    return local;
}

bool finite(const glm::mat4& m) {
    for (int c = 0; c < 4; ++c)
        for (int r = 0; r < 4; ++r)
            if (!std::isfinite(m[c][r])) return false;
    return true;
}

std::string nameOf(const tinygltf::Node& node, size_t index) {
    return node.name.empty() ? fmt::format("node {}", index) : "node " + quoted(node.name);
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

float notNegative(double value) {
    const float single = static_cast<float>(value);
    return std::isfinite(single) && single > 0.0f ? single : 0.0f;
}

void addLight(Build& build, const tinygltf::Light& source, const std::string& node,
              const glm::mat4& transform) {
    const std::string where = "light " + quoted(source.name.empty() ? node : source.name);
    Light light;
    if (source.type == "spot") {
        light.type = LightType::Spot;
    } else if (source.type == "directional") {
        light.type = LightType::Directional;
    } else if (source.type != "point") {
        build.warnings.add(where, fmt::format("has the unknown type {} and is ignored", quoted(source.type)));
        return;
    }
    light.name = source.name.empty() ? node : source.name;
    light.transform = transform;
    for (int c = 0; c < 3; ++c)
        if (source.color.size() == 3) light.color[c] = notNegative(source.color[static_cast<size_t>(c)]);
    light.intensity = notNegative(source.intensity);
    light.range = notNegative(source.range);
    const double outer = std::clamp(source.spot.outerConeAngle, 1e-3, kHalfPi);
    light.outerConeAngle = static_cast<float>(outer);
    light.innerConeAngle = static_cast<float>(std::clamp(source.spot.innerConeAngle, 0.0, outer));
    if (outer != source.spot.outerConeAngle || source.spot.innerConeAngle > outer)
        build.warnings.add(where, "has cone angles out of range, they are clamped");
    build.scene.lights.push_back(std::move(light));
}

std::vector<int> rootNodes(const Build& build) {
    const tinygltf::Model& model = build.model;
    if (!model.scenes.empty())
        return model.scenes[static_cast<size_t>(std::max(model.defaultScene, 0))].nodes;
    std::vector<bool> isChild(model.nodes.size());
    for (const tinygltf::Node& node : model.nodes)
        for (int child : node.children)
            isChild[static_cast<size_t>(child)] = true;
    std::vector<int> roots;
    for (size_t i = 0; i < isChild.size(); ++i)
        if (!isChild[i]) roots.push_back(static_cast<int>(i));
    return roots;
}

void addNode(Build& build, size_t index, const glm::mat4& world) {
    const tinygltf::Node& node = build.model.nodes[index];
    if (!finite(world)) {
        build.warnings.add(nameOf(node, index), "has a transform that is not finite and is ignored");
        return;
    }
    if (node.mesh >= 0 && !build.scene.meshes[static_cast<size_t>(node.mesh)].primitives.empty()) {
        Instance instance;
        instance.name =
            node.name.empty() ? build.scene.meshes[static_cast<size_t>(node.mesh)].name : node.name;
        instance.mesh = node.mesh;
        instance.transform = world;
        build.scene.instances.push_back(std::move(instance));
    }
    if (node.skin >= 0)
        build.warnings.add(nameOf(node, index), "skins are not supported, the rest pose is used");
    if (node.extensions.count("EXT_mesh_gpu_instancing"))
        build.warnings.add(nameOf(node, index),
                           "EXT_mesh_gpu_instancing is not supported, one instance is used");
    if (node.camera >= 0)
        build.scene.cameras.push_back(
            makeCamera(build.model.cameras[static_cast<size_t>(node.camera)], node.name, world));
    const auto extension = node.extensions.find("KHR_lights_punctual");
    if (extension == node.extensions.end()) return;
    const double light = numberOr(extension->second, "light", -1.0);
    if (light < 0.0 || light >= static_cast<double>(build.model.lights.size()))
        throw Error(
            fmt::format("{}: {} names light {}, but there are {}: the file is damaged, export it again",
                        build.path, nameOf(node, index), light, build.model.lights.size()));
    addLight(build, build.model.lights[static_cast<size_t>(light)], node.name, world);
}

} // namespace

void buildNodes(Build& build) {
    struct Visit {
        int node;
        glm::dmat4 parent;
    };
    std::vector<Visit> stack;
    const std::vector<int> roots = rootNodes(build);
    std::vector<bool> visited(build.model.nodes.size());
    for (auto root = roots.rbegin(); root != roots.rend(); ++root)
        stack.push_back({*root, glm::dmat4(1.0)});
    while (!stack.empty()) {
        const Visit visit = stack.back();
        stack.pop_back();
        const size_t index = static_cast<size_t>(visit.node);
        if (visited[index]) continue; // a scene may list a root twice; the check excludes all else
        visited[index] = true;
        const tinygltf::Node& node = build.model.nodes[index];
        const glm::dmat4 world = visit.parent * localTransform(node);
        addNode(build, index, glm::mat4(world));
        for (auto child = node.children.rbegin(); child != node.children.rend(); ++child)
            stack.push_back({*child, world});
    }
}

} // namespace relume::gltf
