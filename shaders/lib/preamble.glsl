// Every shader starts with this.
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#ifndef FUNCTION
#define FUNCTION
#endif
#define INOUT(T) inout T
#include "shared.h"
#include "lib/patch_flags.glsl"
#include "lib/buffers.glsl"
