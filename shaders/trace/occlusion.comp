// Finds the occlusion of pair blocks, with one workgroup per unit and word, one invocation per receiver.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/preamble.glsl"
#include "lib/pairs.glsl"
layout(push_constant, scalar) uniform Push { OcclusionPush push; };
#define geometry push.geometry
#include "lib/rays/trace.glsl"
#include "lib/rays/occlusion.glsl"

layout(local_size_x = 64) in;

void main() {
    uint group = gl_WorkGroupID.y * push.groupsX + gl_WorkGroupID.x;
    if (group >= push.unitCount * 2u) return;
    traceWord(push.firstUnit + group / 2u, group % 2u, gl_LocalInvocationID.x);
}
