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
    vec3 direct = push.direct != 0ul ? Vec4s(push.direct).items[index].rgb : vec3(0.0);
    if (push.share > 0.0)
        carried.items[index] = vec4(mix(carried.items[index].rgb, light.items[index].rgb - direct, push.share), 0.0);
    else
        light.items[index] = vec4(max(direct + carried.items[index].rgb, 0.0), 1.0);
}
