// Sums over all chunks, always in the same order. There is one workgroup per value and group.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/preamble.glsl"
layout(push_constant, scalar) uniform Push { ChunkSumPush push; };

layout(local_size_x = 256) in;

shared float terms[256];

void main() {
    uint i = gl_LocalInvocationID.x, value = gl_WorkGroupID.x, group = gl_WorkGroupID.y;
    Words values = Words(push.values);
    float sum = 0.0;
    for (uint chunk = i; chunk < push.chunkCount; chunk += 256u)
        sum += uintBitsToFloat(values.items[(group * push.chunkCount + chunk) * push.width + value]);
    terms[i] = sum;
    for (uint step = 128u; step > 0u; step /= 2u) {
        barrier();
        if (i < step) terms[i] += terms[i + step];
    }
    if (i == 0u) WORD_AT(push.sums, group * push.width + value) = floatBitsToUint(terms[0]);
}
