#pragma once

#include <vector>

#include <glm/glm.hpp>

#include "assets/model/scene.h"

namespace relume {

struct OutlineSegment {
    glm::vec3 from{0.0f}, to{0.0f}; // [m], world space
};

struct OutlineDesc {
    glm::vec3 right{1.0f, 0.0f, 0.0f}, up{0.0f, 1.0f, 0.0f}; // of the picture: signs stand in its plane
    float size = 1.0f;                                       // of a sign [m]
};
/// Returns lines that show what kind of light stands where and where it shines: its body and cone as they
/// are, signs and directions of one size.
std::vector<OutlineSegment> lightOutline(const Light& light, const OutlineDesc& desc);

} // namespace relume
