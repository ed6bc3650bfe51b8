// How much bounces changed the light, from sums per chunk. One workgroup per pass and lane; always the same order of sums.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/preamble.glsl"
layout(push_constant, scalar) uniform Push { BounceChangePush push; };

layout(local_size_x = 256) in;

shared vec4 terms[256];

void main() {
    uint i = gl_LocalInvocationID.x;
    Vec4s changes = Vec4s(push.changes);
    vec4 sum = vec4(0.0);
    for (uint chunk = i; chunk < push.chunkCount; chunk += 256u)
        sum += changes.items[gl_WorkGroupID.x * push.chunkCount + chunk];
    terms[i] = sum;
    for (uint step = 128u; step > 0u; step /= 2u) {
        barrier();
        if (i < step) terms[i] += terms[i + step];
    }
    if (i == 0u) Vec4s(push.totals).items[gl_WorkGroupID.x] = terms[0];
}
