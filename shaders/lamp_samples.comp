// Ends of rays from the patches of some chunks to a group of lamps. One workgroup per chunk (x) and lamp (y), one invocation
// per patch.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/lamp_group.glsl"

layout(local_size_x = 64) in;

void main() {
    uint chunk = gl_WorkGroupID.x, lane = gl_LocalInvocationID.x;
    Patch p = loadPatch(push.patches, (push.firstChunk + chunk) * kChunk + lane);
    Lamp l = loadLamp(gl_WorkGroupID.y);
    for (uint s = 0u; s < l.samples; ++s) {
        LampRay ray = lampRay(l, p, s);
        Vec4s(push.targets).items[(chunk * push.targetCount + l.firstTarget + s) * kChunk + lane] =
            vec4(ray.target, ray.traced ? 1.0 : 0.0);
    }
}
