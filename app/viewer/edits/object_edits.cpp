#include "app/viewer/edits/object_edits.h"

#include "app/viewer/edits/light_edits.h"
#include "assets/base/error.h"
#include "renderer/scene_gpu.h"

#include <algorithm>
#include <limits>

#include <glm/gtc/matrix_inverse.hpp>
#include <spdlog/fmt/fmt.h>

namespace relume {
namespace {

Box loadedBounds(const LoadedScene& scene, uint32_t instance) {
    Box box;
    for (const SceneDraw& draw : scene.geometry.draws)
        if (draw.instance == instance) box.add(draw.bounds);
    return box;
}

const glm::mat4& loadedTransform(const LoadedScene& scene, uint32_t instance) {
    ASSERT(instance < scene.prepared.scene.instances.size());
    return scene.prepared.scene.instances[instance].transform;
}

// Returns the transform with right-handed unit axes and the same position.
glm::mat4 withoutScale(const glm::mat4& transform) {
    const glm::vec3 scale = scaleOf(transform);
    glm::mat4 plain = transform;
    for (int axis = 0; axis < 3; ++axis)
        if (scale[axis] != 0.0f) plain[axis] /= scale[axis];
    return plain;
}

} // namespace

std::string nameOf(const std::string& name, const char* kind, size_t index) {
    return name.empty() ? fmt::format("{} {}", kind, index) : name;
}

std::string objectName(const Scene& scene, uint32_t instance) {
    return nameOf(scene.instances[instance].name, "instance", instance);
}

glm::mat4 placementOf(const LoadedScene& scene, const SceneEdits& edits, uint32_t instance) {
    const glm::mat4 &from = loadedTransform(scene, instance), &to = edits.placements[instance].transform;
    return from == to ? glm::mat4(1.0f) : placementBetween(from, to);
}

std::optional<glm::vec3> pivotOf(const LoadedScene& scene, const SceneEdits& edits, uint32_t instance) {
    const Box box = loadedBounds(scene, instance);
    if (box.empty()) return std::nullopt;
    return glm::vec3(placementOf(scene, edits, instance) * glm::vec4(box.centre(), 1.0f));
}

Box placedBounds(const LoadedScene& scene, const SceneEdits& edits, uint32_t instance) {
    const WorldMesh& mesh = scene.prepared.mesh;
    const glm::mat4 placement = placementOf(scene, edits, instance);
    Box box;
    for (size_t i = 0; i < mesh.triangleCount(); ++i)
        for (size_t k = 0; k < 3 && mesh.instance[i] == instance; ++k)
            box.add(glm::vec3(placement * glm::vec4(mesh.positions[3 * i + k], 1.0f)));
    return box;
}

glm::vec3 placedNormalAt(const LoadedScene& scene, const SceneEdits& edits, uint32_t instance,
                         const glm::vec3& position, const glm::vec3& towards) {
    const glm::mat4 placement = placementOf(scene, edits, instance), back = glm::inverse(placement);
    const glm::vec3 normal =
        normalAt(scene.prepared.mesh, instance, glm::vec3(back * glm::vec4(position, 1.0f)),
                 glm::normalize(glm::mat3(back) * towards));
    return glm::normalize(glm::inverseTranspose(glm::mat3(placement)) * normal);
}

glm::vec3 scaleOf(const glm::mat4& transform) {
    const glm::mat3 axes(transform);
    glm::vec3 scale(glm::length(axes[0]), glm::length(axes[1]), glm::length(axes[2]));
    if (glm::determinant(axes) < 0.0f) scale.x = -scale.x;
    return scale;
}

glm::vec3 anglesOf(const glm::mat4& transform) {
    return lightAngles(withoutScale(transform)) + 0.0f; // no -0 to be read
}

glm::mat4 turnedTo(const glm::mat4& transform, const glm::vec3& degrees) {
    const glm::mat3 then(withAngles(glm::mat4(1.0f), anglesOf(transform))),
        now(withAngles(glm::mat4(1.0f), degrees));
    glm::mat4 turned(now * glm::transpose(then) * glm::mat3(transform));
    turned[3] = transform[3];
    return turned;
}

glm::mat4 scaledTo(const glm::mat4& transform, const glm::vec3& scale) {
    const glm::vec3 before = scaleOf(transform);
    glm::mat4 scaled = transform;
    for (int axis = 0; axis < 3; ++axis)
        if (before[axis] != 0.0f) scaled[axis] *= scale[axis] / before[axis];
    return scaled;
}

glm::mat4 restingOn(const MovedObject& object, const glm::vec3& position, const glm::vec3& normal) {
    const WorldMesh& mesh = object.scene.prepared.mesh;
    const glm::mat4 placement =
        placementBetween(loadedTransform(object.scene, object.instance), object.begin);
    float lowest = std::numeric_limits<float>::max();
    for (size_t i = 0; i < mesh.triangleCount(); ++i)
        for (size_t k = 0; k < 3 && mesh.instance[i] == object.instance; ++k)
            lowest = std::min(
                lowest, glm::dot(normal, glm::vec3(placement * glm::vec4(mesh.positions[3 * i + k], 1.0f))));
    if (lowest == std::numeric_limits<float>::max()) return object.begin;
    const glm::vec3 middle(placement * glm::vec4(loadedBounds(object.scene, object.instance).centre(), 1.0f));
    glm::mat4 moved = object.begin;
    moved[3] += glm::vec4(position - middle + (glm::dot(normal, middle) - lowest) * normal, 0.0f);
    return moved;
}

} // namespace relume
