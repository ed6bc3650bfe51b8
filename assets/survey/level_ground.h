#pragma once

#include <vector>

#include "assets/survey/level_rays.h"

namespace relume {

/// The ground of a level on which one can walk about under the open sky.
struct LevelGround {
    std::vector<glm::vec3> places; // [m], on the ground, of a grid
    /// Tells whether triangles have a front and a back: seen from above, nearly all show fronts. Levels come
    /// with doubled faces and with faces turned wrong, too; their sides then say nothing.
    bool sided = true;
};

/// Returns the pieces of ground that are level enough to walk on, have head room, hang together and are as
/// large as a street, flat roofs among them; of these the places from which the sky is seen straight up.
/// There are none where a level is smaller or larger than towns are. It is taken to be in metres.
LevelGround findGround(const LevelRays& rays, const glm::vec3& low, const glm::vec3& high);

} // namespace relume
