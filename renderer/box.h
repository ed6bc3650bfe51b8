#pragma once

#include <limits>

#include <glm/glm.hpp>

namespace relume {

/// An axis-aligned box is empty until something is added.
struct Box {
    glm::vec3 low{std::numeric_limits<float>::max()};
    glm::vec3 high{std::numeric_limits<float>::lowest()};

    void add(const glm::vec3& point) {
        low = glm::min(low, point);
        high = glm::max(high, point);
    }
    void add(const Box& other) {
        low = glm::min(low, other.low);
        high = glm::max(high, other.high);
    }
    bool empty() const { return low.x > high.x; }
    glm::vec3 centre() const { return 0.5f * (low + high); }
    glm::vec3 size() const { return high - low; }
    float diagonal() const { return glm::length(size()); }
    /// Returns one of the eight corners; x changes fastest.
    glm::vec3 corner(int index) const {
        return {(index & 1) != 0 ? high.x : low.x, (index & 2) != 0 ? high.y : low.y,
                (index & 4) != 0 ? high.z : low.z};
    }
};

/// Returns the box around a box that was transformed; an empty one stays empty.
inline Box transformed(const Box& box, const glm::mat4& transform) {
    Box result;
    for (int i = 0; i < 8 && !box.empty(); ++i)
        result.add(glm::vec3(transform * glm::vec4(box.corner(i), 1.0f)));
    return result;
}

} // namespace relume
