// Makes the light that bounces on: direct light and the mean of all links so far. Or it makes direct light
// itself from its sums, as direct.comp does. There is one workgroup per chunk.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/preamble.glsl"
layout(push_constant, scalar) uniform Push { ComposePush push; };

layout(local_size_x = 64) in;

void main() {
    uint chunk = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    if (chunk >= push.chunkCount) return;
    uint index = (push.firstChunk + chunk) * kChunk + gl_LocalInvocationID.x;
    vec3 sum = vec3(0.0);
    for (uint q = 0u; q < kReplicates; ++q) sum += VEC4_AT(push.sums, q * push.patchCount + index).rgb;
    vec3 direct = vec4IfAny(push.direct, index, push.sums).rgb;
    vec2 scales = vec2IfAny(push.scales, index / kChunk, push.sums, vec2(0.0));
    float scale = push.scales != 0ul ? scales[push.sampled] / float(kReplicates) : push.scale;
    VEC4_AT(push.light, index) = vec4(max(direct + sum * scale, 0.0), 1.0);
}
