#pragma once

#include <span>
#include <vector>

#include "assets/survey/level_rays.h"
#include "renderer/camera.h"

namespace relume {

/// A patch as a person sees it.
struct LitPoint {
    glm::vec3 position{0.0f}, normal{0.0f, 1.0f, 0.0f}; // [m]; unit
    float area = 0;                                     // [m^2]
    float light = 0;                                    // mean of R, G and B
};

/// Returns at most `count` cameras that look at dark places of a level, the one that sees most of them first.
/// Each is a standing eye 1.6 m above a floor patch in the darkest quarter of all patches that are not black,
/// and looks along the longest free horizontal direction, or to the open where every one is. It sees dark
/// patches that no camera before it has seen. Where nobody can stand, as in models that are small, the eye is
/// at half the free height. A pure function of what it is given; the same floor gives the same cameras.
std::vector<ViewCamera> darkViews(const LevelRays& rays, std::span<const LitPoint> points, size_t count);

} // namespace relume
