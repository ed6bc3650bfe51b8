// Packs what patches (and nodes behind them) send into 8 bytes each, for the links that read it.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/preamble.glsl"
#include "lib/packed_light.glsl"
layout(push_constant, scalar) uniform Push { PackPush push; };

layout(local_size_x = 64) in;

void main() {
    uint i = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u + gl_LocalInvocationID.x;
    if (i >= push.count) return;
    UVEC2_AT(push.packed, i) = packLight(VEC4_AT(push.radiance, i).rgb);
}
