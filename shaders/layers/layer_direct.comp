// Makes the direct light of a layer: the mean of all sample passes, from that of the passes before and the
// sums of new ones. There is one invocation per patch.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/preamble.glsl"
layout(push_constant, scalar) uniform Push { LayerDirectPush push; };
#include "lib/replicates.glsl"
#include "lib/light/penumbra.glsl"

layout(local_size_x = 64) in;

void main() {
    uint index = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u + gl_LocalInvocationID.x;
    if (index >= push.patchCount) return;
    uint kind = inPenumbra(index) ? 1u : 0u;
    float scale = push.scale[kind], share = push.share[kind];
    if (share == 0.0) return;
    vec3 value[kReplicates], sum = vec3(0.0);
    for (uint q = 0u; q < kReplicates; ++q) {
        value[q] = scale * VEC4_AT(push.sums, q * push.patchCount + index).rgb;
        sum += value[q];
    }
    vec3 mean = max(sum / float(kReplicates), 0.0);
    float variance = spread(value);
    if (share < 1.0) {
        // The points of all sample passes together are spread evenly, so that the variance falls faster than if
        // these were independent of those before. That it falls as one over their number is the least.
        mean = mix(VEC4_AT(push.direct, index).rgb, mean, share);
        variance *= share;
    }
    VEC4_AT(push.direct, index) = vec4(mean, variance);
}
