// Mixes the layers to be shown: the sum of each one's light times its weight. Their errors are taken to be independent,
// so that variances add up. There is one invocation per patch.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/preamble.glsl"
layout(push_constant, scalar) uniform Push { LayerMixPush push; };
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer Weights { LayerWeight items[]; };

layout(local_size_x = 64) in;

void main() {
    uint index = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u + gl_LocalInvocationID.x;
    if (index >= push.patchCount) return;
    vec4 sum = vec4IfAny(push.base, index, push.layers);
    sum.w *= sum.w;
    for (uint i = 0u; i < push.layerCount; ++i) {
        LayerWeight layer = Weights(push.layers).items[i];
        vec4 light = VEC4_AT(layer.light, index);
        float off = max(max(layer.weight.r, layer.weight.g), layer.weight.b) * light.w;
        sum += vec4(layer.weight * light.rgb, off * off);
    }
    sum.w = sqrt(sum.w);
    VEC4_AT(push.light, index) = sum;
}
