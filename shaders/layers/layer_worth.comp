// Sums over each chunk what a layer has of the composite's variance, as it is and by what it is worth for its local
// error. There is one workgroup per chunk.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/preamble.glsl"
#include "lib/local_error.glsl"
layout(push_constant, scalar) uniform Push { LayerWorthPush push; };

layout(local_size_x = 64) in;

shared vec4 terms[kChunk];

void main() {
    uint chunk = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x, lane = gl_LocalInvocationID.x;
    if (chunk >= push.chunkCount) return;
    uint index = chunk * kChunk + lane;
    terms[lane] = vec4(0.0);
    if (patchIsShown(loadPatch(push.patches, index).flags)) {
        vec4 all = VEC4_AT(push.composite, index);
        float own = max((all.r + all.g + all.b) / 3.0, push.least);
        float off = push.deviation * all.w / own;
        float direct = VEC4_AT(push.direct, index).w / 3.0, error = VEC4_AT(push.result, index).w;
        vec2 variance = vec2(direct, max(error * error - direct, 0.0));
        terms[lane] = vec4(variance * (localWorth(off, push.aim) / (own * own)), variance);
    }
    barrier();
    if (lane != 0u) return;
    vec4 sum = terms[0];
    for (uint i = 1u; i < kChunk; ++i) sum += terms[i];
    VEC4_AT(push.chunkSums, chunk) = sum;
}
