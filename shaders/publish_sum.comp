// Sums over kSumChunks chunks each: one workgroup per sum, in a fixed order.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/preamble.glsl"
layout(push_constant, scalar) uniform Push { PublishSumPush push; };

layout(local_size_x = 64) in;

shared vec4 terms[64];

void main() {
    uint group = gl_WorkGroupID.x, lane = gl_LocalInvocationID.x;
    uint end = min((group + 1u) * kSumChunks, push.chunkCount);
    vec4 sum = vec4(0.0);
    for (uint c = group * kSumChunks + lane; c < end; c += 64u) sum += Vec4s(push.sums).items[c];
    terms[lane] = sum;
    barrier();
    if (lane != 0u) return;
    for (uint i = 1u; i < 64u; ++i) sum += terms[i];
    Vec4s(push.totals).items[group] = sum;
}
