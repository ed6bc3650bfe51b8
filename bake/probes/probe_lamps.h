#pragma once

#include <cstdint>

#include <glm/glm.hpp>

#include "bake/base/shader_types.h"

namespace relume {

/// One ray from a probe to an analytic light, and the light that it brings if nothing is in between.
struct ProbeLampRay {
    glm::vec3 target{0.0f};    // [m]
    glm::vec3 direction{0.0f}; // unit
    float lux = 0;             // per unit of the light's colour, on a surface that faces it
};

/// Returns ray `sample` of the probe of this number, which stands at `point` [m], to the light. `reach` [m]
/// is how far rays to suns go, which nothing but their targets depends on. Every probe draws points of its
/// own, the same each time.
ProbeLampRay sampleProbeLamp(const shader::Lamp& lamp, const glm::vec3& point, uint32_t probe,
                             uint32_t sample, float reach);

} // namespace relume
