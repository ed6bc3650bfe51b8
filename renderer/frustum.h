#pragma once

#include <array>

#include <glm/glm.hpp>

#include "renderer/box.h"

namespace relume {

/// Holds the planes that bound what a picture shows: left, right, bottom, top and near.
class Frustum {
public:
    /// Takes projectionMatrix times viewMatrix.
    explicit Frustum(const glm::mat4& viewProjection);

    /// Returns false only where nothing of the box is in the picture; a box near the picture's edge may count
    /// as seen.
    bool sees(const Box& box) const;

private:
    std::array<glm::vec4, 5> planes_; // dot(plane, (point, 1)) >= 0 inside
};

} // namespace relume
