// Mixes the direct light of all layers: the sum of each one's times its weight. Lights share random numbers,
// so that their errors may have one sign: standard deviations are added. There is one invocation per patch.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/preamble.glsl"
layout(push_constant, scalar) uniform Push { LayerMixPush push; }; // light, w: variance of R, G and B together
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer Weights { LayerWeight items[]; };

layout(local_size_x = 64) in;

void main() {
    uint index = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u + gl_LocalInvocationID.x;
    if (index >= push.patchCount) return;
    vec4 sum = vec4(0.0);
    for (uint i = 0u; i < push.layerCount; ++i) {
        LayerWeight layer = Weights(push.layers).items[i];
        vec4 direct = VEC4_AT(layer.light, index);
        float strongest = max(max(layer.weight.r, layer.weight.g), layer.weight.b);
        sum += vec4(layer.weight * direct.rgb, strongest * sqrt(direct.w));
    }
    VEC4_AT(push.light, index) = vec4(sum.rgb, sum.w * sum.w);
}
