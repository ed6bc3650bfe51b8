// Makes the light that links read next. With a share, what a sample pass has brought is mixed into what is carried from
// pass to pass; else the light is direct light and what is carried. There is one invocation per patch.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/preamble.glsl"
layout(push_constant, scalar) uniform Push { CarryPush push; };

layout(local_size_x = 64) in;

void main() {
    uint index = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u + gl_LocalInvocationID.x;
    if (index >= push.patchCount) return;
    Vec4s carried = Vec4s(push.carried), light = Vec4s(push.light);
    vec3 direct = vec4IfAny(push.direct, index, push.carried).rgb;
    if (push.share > 0.0)
        VEC4_AT(carried, index) = vec4(mix(VEC4_AT(carried, index).rgb, VEC4_AT(light, index).rgb - direct, push.share), 0.0);
    else
        VEC4_AT(light, index) = vec4(max(direct + VEC4_AT(carried, index).rgb, 0.0), 1.0);
}
