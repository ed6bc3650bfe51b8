// values[i] = FACTOR * (i + offset) * scale
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#include "factor.glsl"

layout(constant_id = 0) const uint kOffset = 0u;
layout(constant_id = 1) const uint kScale = 1u;

layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Words { uint items[]; };
layout(push_constant, scalar) uniform Push {
    uint64_t values;
    uint count;
} push;

layout(local_size_x = 64) in;

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i < push.count) Words(push.values).items[i] = scaled(i + kOffset) * kScale;
}
