#include "renderer/frustum.h"

#include <algorithm>

namespace relume {

// The planes are sums of the matrix' rows [Gribb and Hartmann 2001]. Near is where depth is 1 (reversed), so
// z <= w.
Frustum::Frustum(const glm::mat4& viewProjection) {
    const glm::mat4 rows = glm::transpose(viewProjection);
    planes_ = {rows[3] + rows[0], rows[3] - rows[0], rows[3] + rows[1], rows[3] - rows[1], rows[3] - rows[2]};
}

bool Frustum::sees(const Box& box) const {
    return std::all_of(planes_.begin(), planes_.end(), [&](const glm::vec4& plane) {
        // This is the corner farthest along the plane's normal.
        const glm::vec3 corner(plane.x > 0.0f ? box.high.x : box.low.x,
                               plane.y > 0.0f ? box.high.y : box.low.y,
                               plane.z > 0.0f ? box.high.z : box.low.z);
        return glm::dot(glm::vec3(plane), corner) + plane.w >= 0.0f;
    });
}

} // namespace relume
