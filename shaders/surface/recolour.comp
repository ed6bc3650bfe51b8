// Sets the albedo of patches by the base colours of their materials where these have changed. There is one
// invocation per patch.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/preamble.glsl"
#include "shared_objects.h"
layout(push_constant, scalar) uniform Push { RecolourPush push; };

layout(local_size_x = 64) in;

void main() {
    uint i = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u + gl_LocalInvocationID.x;
    if (i >= push.patchCount) return;
    vec4 base = VEC4_AT(push.baseColors, WORD_AT(push.materials, i));
    if (base.a < 0.0) return;
    VEC4_AT(push.albedo, i) = min(base * VEC4_AT(push.pattern, i), vec4(push.maxAlbedo));
}
