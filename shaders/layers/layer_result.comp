// Makes a layer's light: direct and indirect, with its standard error in w, and sums over each chunk. There
// is one workgroup per chunk.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/preamble.glsl"
layout(push_constant, scalar) uniform Push { LayerResultPush push; };

layout(local_size_x = 64) in;

shared vec4 terms[kChunk];

void main() {
    uint chunk = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x, lane = gl_LocalInvocationID.x;
    if (chunk >= push.chunkCount) return;
    uint index = chunk * kChunk + lane;
    vec4 direct = VEC4_AT(push.direct, index);
    vec4 indirect = vec4IfAny(push.indirect, index, push.direct);
    vec3 light = direct.rgb + indirect.rgb;
    VEC4_AT(push.result, index) = vec4(light, sqrt(direct.w / 3.0 + indirect.w * indirect.w));
    uint flags = loadPatch(push.patches, index).flags;
    bool counts = patchIsShown(flags);
    terms[lane] = counts ? vec4(light.r + light.g + light.b, direct.w, 1.0, 0.0) : vec4(0.0);
    barrier();
    if (lane != 0u) return;
    vec4 sum = terms[0];
    for (uint i = 1u; i < kChunk; ++i) sum += terms[i];
    VEC4_AT(push.chunkSums, chunk) = sum;
}
