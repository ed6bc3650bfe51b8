// Ends a bounce. In the RTRad preset emission is added, and patches whose emission is brighter than 0.1 keep
// their value.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/preamble.glsl"
layout(push_constant, scalar) uniform Push { FinishPush push; };

const float kRtradLight = 0.1;

layout(local_size_x = 64) in;

void main() {
    uint index = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u + gl_LocalInvocationID.x;
    if (index >= push.patchCount) return;
    Vec4s ligOut = Vec4s(push.ligOut);
    vec4 light = vec4(ligOut.items[index].rgb, 1.0);
    if (push.rtrad != 0u) {
        vec3 emission = Vec4s(push.emission).items[index].rgb;
        light.rgb += emission;
        if (length(emission) > kRtradLight) light = Vec4s(push.ligIn).items[index];
    }
    ligOut.items[index] = light;
}
