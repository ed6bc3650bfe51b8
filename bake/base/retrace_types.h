#pragma once

#include "bake/base/shader_types.h"

namespace relume::shader {
#include "shaders/shared_objects.h"
#include "shaders/lib/rays/boxes.glsl"

static_assert(sizeof(TraceBox) == 24 && sizeof(RetraceMarkPush) <= 128 && sizeof(RetracePush) <= 128);
} // namespace relume::shader
