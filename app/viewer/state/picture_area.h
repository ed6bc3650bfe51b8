#pragma once

#include <glm/glm.hpp>

namespace relume {

/// The part of the window that shows the scene, in screen coordinates from the upper left.
struct PictureArea {
    glm::vec2 corner{0.0f}, size{0.0f};

    bool has(const glm::dvec2& at) const {
        const glm::vec2 p(at), high = corner + size;
        return p.x >= corner.x && p.y >= corner.y && p.x < high.x && p.y < high.y;
    }
    float aspect() const { return size.y > 0 ? size.x / size.y : 1.0f; }
};

} // namespace relume
