// What each patch sends in this pass, formed once: emission + reflectivity * albedo * lighting [cd/m^2]; in the RTRad
// preset ligIn itself. Also notes which chunks send at all. One invocation per chunk.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/preamble.glsl"
layout(push_constant, scalar) uniform Push { RadiancePush push; };

layout(local_size_x = 64) in;

void main() {
    uint chunk = gl_GlobalInvocationID.x;
    if (chunk >= push.chunkCount) return;
    uint sends = push.all;
    for (uint i = chunk * kChunk; i < (chunk + 1u) * kChunk; ++i) {
        vec4 radiance = vec4(0.0);
        if ((loadPatch(push.patches, i).flags & kPatchSends) != 0u) {
            vec4 ligIn = Vec4s(push.ligIn).items[i];
            radiance = ligIn;
            if (push.rtrad == 0u) {
                vec3 reflected = push.reflectivity * Vec4s(push.albedo).items[i].rgb * ligIn.rgb;
                radiance = vec4(Vec4s(push.emission).items[i].rgb + reflected, 0.0);
            }
        }
        if (radiance.r != 0.0 || radiance.g != 0.0 || radiance.b != 0.0) sends = 1u;
        Vec4s(push.radiance).items[i] = radiance;
    }
    Words(push.chunkSends).items[chunk] = sends;
}
