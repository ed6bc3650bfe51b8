// Does the first half of smoothing the indirect light: along rows of texels, each replicate by itself. There
// is one workgroup per chunk.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/preamble.glsl"
layout(push_constant, scalar) uniform Push { SmoothPush push; };
#include "lib/smoothing.glsl"

layout(local_size_x = 64) in;

void main() {
    uint chunk = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    if (chunk >= push.chunkCount) return;
    uint index = (push.firstChunk + chunk) * kChunk + gl_LocalInvocationID.x;
    Taps taps = smoothingTaps(index, ivec2(1, 0));
    vec3 value[kReplicates];
    for (uint q = 0u; q < kReplicates; ++q) value[q] = vec3(0.0);
    for (uint t = 0u; t < 2u * push.reach + 1u; ++t) {
        if (taps.weight[t] == 0.0) continue;
        float weight = taps.weight[t] * vec2IfAny(push.scales, taps.index[t] / kChunk, push.patches, vec2(1.0)).x;
        for (uint q = 0u; q < kReplicates; ++q)
            value[q] += weight * VEC4_AT(push.sums, q * push.patchCount + taps.index[t]).rgb;
    }
    for (uint q = 0u; q < kReplicates; ++q) VEC4_AT(push.rows, q * push.patchCount + index) = vec4(value[q], 0.0);
}
