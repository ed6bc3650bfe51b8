#pragma once

#include <glm/glm.hpp>
#include <nlohmann/json.hpp>

#include "assets/gltf/edit/gltf_edit_json.h"

namespace relume::gltf {

struct TransformEdit {
    glm::dmat4 parent{1.0};         // to world
    glm::mat4 from{1.0f}, to{1.0f}; // to world, as the scene had it and is to have it
    bool rigid = false;             // what moves has no size: the node keeps its scale
    bool mayBeMatrix = true;        // a node without matrix may get one, where it takes a shear
};

/// Writes a node's transform, in the form it has: `was` is the node as it was. Numbers that stay keep their
/// spelling. Returns false and writes nothing where the node would have to get a matrix and may not.
[[nodiscard]] bool editTransform(EditedJson& node, const nlohmann::json& was, const TransformEdit& edit);

/// Tells whether a transform can be inverted, so that nodes below it can be placed.
bool invertible(const glm::dmat4& transform);

/// Returns a rotation that keeps the Z axis of `axes` and, as far as that goes, the X axis; identity where
/// there is no Z axis.
glm::dmat3 frame(const glm::dmat3& axes);

/// Splits `linear` into a rotation and a scale whose product it is, with the signs of `scale`. Returns false
/// for a shear, and where an axis has no length.
[[nodiscard]] bool splitLinear(const glm::dmat3& linear, glm::dmat3& rotation, glm::dvec3& scale);

/// Writes translation and rotation, leaving out those that change nothing.
void writeRigid(EditedJson& node, const glm::mat4& transform);

} // namespace relume::gltf
