// Spreads the light that links brought to the receivers of a coarser grid to all patches. There is one
// workgroup per chunk and one invocation per patch.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/preamble.glsl"
layout(push_constant, scalar) uniform Push { InterpolatePush push; };


layout(local_size_x = 64) in;

void main() {
    uint chunk = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    if (chunk >= push.chunkCount) return;
    uint index = (push.firstChunk + chunk) * kChunk + gl_LocalInvocationID.x;
    Rows taps = Rows(push.taps);
    uvec4 receivers = taps.items[index * 2u];
    vec4 weights = uintBitsToFloat(taps.items[index * 2u + 1u]);
    vec3 sum[kReplicates];
    for (uint q = 0u; q < kReplicates; ++q) sum[q] = vec3(0.0);
    for (uint t = 0u; t < 4u; ++t) {
        if (weights[t] == 0.0) continue;
        for (uint q = 0u; q < kReplicates; ++q)
            sum[q] += weights[t] * VEC4_AT(push.coarse, q * push.receiverCount + receivers[t]).rgb;
    }
    if (push.distances != 0ul) { // harmonic means, like these themselves
        for (uint axis = 0u; axis < 2u; ++axis) {
            float inverse = 0.0;
            for (uint t = 0u; t < 4u; ++t) {
                if (weights[t] == 0.0) continue;
                inverse += weights[t] / FLOAT_AT(push.coarseDistances, 2u * receivers[t] + axis);
            }
            FLOAT_AT(push.distances, 2u * index + axis) = 1.0 / max(inverse, 1e-30);
        }
    }
    vec3 total = sum[0] + sum[1] + sum[2] + sum[3];
    vec3 direct = vec4IfAny(push.direct, index, push.coarse).rgb;
    VEC4_AT(push.ligOut, index) = vec4(direct + push.scale * total, 1.0);
    if (push.sums != 0ul) {
        Vec4s sums = Vec4s(push.sums);
        for (uint q = 0u; q < kReplicates; ++q) VEC4_AT(sums, q * push.patchCount + index).rgb += sum[q];
    }
}
