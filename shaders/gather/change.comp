// Tells how much a bounce changed the light, summed over each chunk: x squares of the difference, y the
// light, z patches, w the difference relative to the light (relativeChange), or of the first bounce the light
// before. There is one workgroup per chunk.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/preamble.glsl"
#include "lib/relative_change.glsl"
layout(push_constant, scalar) uniform Push { ChangePush push; };

layout(local_size_x = 64) in;

shared vec4 terms[kChunk];

void main() {
    uint chunk = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x, lane = gl_LocalInvocationID.x;
    if (chunk >= push.chunkCount) return;
    uint index = chunk * kChunk + lane;
    uint flags = loadPatch(push.patches, index).flags;
    vec4 term = vec4(0.0);
    if (patchIsShown(flags)) {
        vec3 now = VEC4_AT(push.ligOut, index).rgb, before = VEC4_AT(push.ligIn, index).rgb, change = now - before;
        float last = push.isFirst != 0u ? before.r + before.g + before.b : relativeChange(now, change);
        term = vec4(dot(change, change), now.r + now.g + now.b, 1.0, last);
    }
    terms[lane] = term;
    barrier();
    if (lane != 0u) return;
    for (uint i = 1u; i < kChunk; ++i) term += terms[i];
    VEC4_AT(push.sums, chunk) = term;
}
