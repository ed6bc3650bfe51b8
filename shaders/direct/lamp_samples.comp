// Makes the ends of rays from the patches of some chunks to a group of analytic lights. There is one
// workgroup per chunk (x) and light (y), and one invocation per patch.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/light/lamp_group.glsl"

layout(local_size_x = 64) in;

void main() {
    uint chunk = gl_WorkGroupID.x, lane = gl_LocalInvocationID.x;
    uint index = listedChunk(chunk) * kChunk + lane;
    Receiver r = receiver(index);
    Lamp l = loadLamp(gl_WorkGroupID.y);
    uint samples = lampNote(l, r, index, gl_WorkGroupID.y).asked ? takenSamples(l, takenSamplePasses(index)) : 0u;
    for (uint s = 0u; s < targetsOf(l); ++s) {
        vec4 target = vec4(0.0);
        if (s < samples) {
            LampRay ray = lampRay(l, r, s);
            float light = isLamp(l, kLampSky) ? (ray.traced ? 1.0 : 0.0) : ray.light.r;
            target = vec4(ray.target, ray.traced ? light : -light);
        }
        VEC4_AT(push.targets, (chunk * targetCount() + l.firstTarget + s) * kChunk + lane) = target;
    }
}
