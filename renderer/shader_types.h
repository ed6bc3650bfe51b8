#pragma once

#include <cstdint>

#include <glm/glm.hpp>

// This does for what is drawn what bake/base/shader_types.h does for the kernels; a source may include both.
#ifndef FUNCTION
#define FUNCTION inline
#endif
#ifndef CONST
#define CONST constexpr
#endif

namespace relume::shader {
using namespace glm; // GLSL's names: vec3, uint, dot, ...
using glm::uint;
#include "shaders/lib/heat.glsl"
#include "shaders/lib/tone.glsl"
#include "shaders/lib/scene_material.glsl"

static_assert(sizeof(SceneMaterial) == 48);
} // namespace relume::shader
