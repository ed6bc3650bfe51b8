#include "bake/surface/triangle_frame.h"

#include <cmath>

namespace relume {

TriangleFrame triangleFrame(const WorldMesh& mesh, uint32_t triangle, uint32_t size) {
    const glm::vec3* p = &mesh.positions[size_t{triangle} * 3];
    const glm::vec2* t = &mesh.lightmapUv[size_t{triangle} * 3];
    const glm::dvec3 e1(glm::dvec3(p[1]) - glm::dvec3(p[0])), e2(glm::dvec3(p[2]) - glm::dvec3(p[0]));
    const glm::dvec2 f1(glm::dvec2(t[1]) - glm::dvec2(t[0])), f2(glm::dvec2(t[2]) - glm::dvec2(t[0]));
    const glm::dvec3 n = glm::cross(e1, e2);
    TriangleFrame frame;
    frame.area = static_cast<float>(0.5 * glm::length(n));
    frame.normal = glm::vec3(glm::normalize(n));
    const double det = (f1.x * f2.y - f1.y * f2.x) * size;
    if (std::abs(det) > 0.0) {
        frame.du = glm::vec3((e1 * f2.y - e2 * f1.y) / det);
        frame.dv = glm::vec3((e2 * f1.x - e1 * f2.x) / det);
    }
    return frame;
}

} // namespace relume
