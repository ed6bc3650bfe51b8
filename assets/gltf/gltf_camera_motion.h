#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "assets/gltf/gltf.h"

namespace relume {

/// How a file's first animation moves one of its cameras.
struct CameraMotion {
    double seconds = 0;          // of the animation, from 0 on
    std::vector<Camera> cameras; // the camera at times that are equally far apart, from 0 to `seconds`
};

/// Reads how the camera of this name ("": the first one that is moved) moves, at `rate` times per second and
/// at both ends.
/// Throws Error where the file cannot be read, has no animation or no such camera, or where the animation
/// moves neither the camera nor a node above it, or would take more than `most` cameras.
CameraMotion readCameraMotion(const std::string& path, const GltfChoice& choice, const std::string& name,
                              double rate, uint32_t most);

} // namespace relume
