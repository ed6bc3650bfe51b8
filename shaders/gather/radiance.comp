// Makes what each patch sends in this bounce, once: emission + reflectivity * albedo * lighting [cd/m^2]; in
// the RTRad preset ligIn itself. Also notes which chunks send at all. There is one workgroup per chunk and
// one invocation per patch.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/preamble.glsl"
layout(push_constant, scalar) uniform Push { RadiancePush push; };

layout(local_size_x = 64) in;

shared uint sends;

void main() {
    uint chunk = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x, lane = gl_LocalInvocationID.x;
    if (chunk >= push.chunkCount) return;
    if (lane == 0u) sends = push.all;
    barrier();
    uint i = chunk * kChunk + lane;
    vec4 radiance = vec4(0.0);
    if ((loadPatch(push.patches, i).flags & kPatchSends) != 0u) {
        vec4 ligIn = VEC4_AT(push.ligIn, i);
        radiance = ligIn;
        if (push.rtrad == 0u) {
            vec3 reflected = push.reflectivity * VEC4_AT(push.albedo, i).rgb * ligIn.rgb;
            vec3 emitted = push.reflected != 0u ? vec3(0.0) : VEC4_AT(push.emission, i).rgb;
            radiance = vec4(emitted + reflected, 0.0);
        }
    }
    VEC4_AT(push.radiance, i) = radiance;
    if (radiance.r != 0.0 || radiance.g != 0.0 || radiance.b != 0.0) atomicOr(sends, 1u);
    barrier();
    if (lane == 0u) WORD_AT(push.chunkSends, chunk) = sends;
}
