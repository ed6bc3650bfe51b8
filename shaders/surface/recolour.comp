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
    vec4 base = Vec4s(push.baseColors).items[Words(push.materials).items[i]];
    if (base.a < 0.0) return;
    Vec4s(push.albedo).items[i] = min(base * Vec4s(push.pattern).items[i], vec4(push.maxAlbedo));
}
