#pragma once

#include <string>

#include "assets/model/scene.h"

namespace tinygltf {
struct Camera;
}

namespace relume::gltf {

/// Returns the camera of a node of this name, which stands at `transform`.
Camera makeCamera(const tinygltf::Camera& source, const std::string& name, const glm::mat4& transform);

} // namespace relume::gltf
