#pragma once

#include <limits>
#include <memory>

#include "assets/atlas/world_mesh.h"

namespace relume {

/// Says what a ray meets first.
struct LevelHit {
    float distance = std::numeric_limits<float>::infinity(); // in lengths of the direction; infinite: nothing
    bool front = false;                                      // of the triangle, else its back
    glm::vec3 normal{0.0f};                                  // unit, of the triangle's front
};

/// The triangles of a level, for some thousand rays that look around in it. Triangles with an alpha mask
/// count as whole. It is made in a fraction of the time that a bake's scene takes, and rays may be traced
/// from any thread.
class LevelRays {
public:
    /// Copies what it needs of the mesh. Throws Error where there is no memory for it.
    explicit LevelRays(const WorldMesh& mesh);
    ~LevelRays();
    LevelRays(LevelRays&&) noexcept;

    /// Returns what a ray from `origin` along `direction` (of any length) meets.
    LevelHit trace(const glm::vec3& origin, const glm::vec3& direction) const;
    /// Returns how far the nearest triangle is from a point [m], infinity in an empty level.
    float clearance(const glm::vec3& point) const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace relume
