// Gathers light over links, sample by sample of each replicate: the mean radiance of what cosine-distributed
// directions hit is lighting. There is one workgroup per chunk and one invocation per patch.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/preamble.glsl"
#include "lib/packed_light.glsl"
layout(push_constant, scalar) uniform Push { LinkPush push; };

layout(local_size_x = 64) in;

vec3 sent(uint link) {
    if (link >= kLinkFirstSpecial) return link == kLinkSky ? push.sky : vec3(0.0);
    return unpackLight(UVEC2_AT(push.packed, link));
}

void main() {
    uint chunk = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    if (chunk >= push.chunkCount) return;
    uint lane = gl_LocalInvocationID.x, index = (push.firstChunk + chunk) * kChunk + lane;
    Words links = Words(push.links);
    vec3 sum[kReplicates];
    for (uint q = 0u; q < kReplicates; ++q) sum[q] = vec3(0.0);
    for (uint k = 0u; k < push.sampleCount; k += kReplicates) {
        uint row = (chunk * push.sampleCount + k) * kChunk + lane;
        for (uint q = 0u; q < kReplicates; ++q) sum[q] += sent(WORD_AT(links, row + q * kChunk));
    }
    vec3 total = sum[0] + sum[1] + sum[2] + sum[3];
    vec3 direct = vec4IfAny(push.direct, index, push.links).rgb;
    if (push.ligOut != 0ul) VEC4_AT(push.ligOut, index) = vec4(direct + total / float(push.sampleCount), 1.0);
    if (push.sums != 0ul) {
        Vec4s sums = Vec4s(push.sums);
        for (uint q = 0u; q < kReplicates; ++q) VEC4_AT(sums, q * push.patchCount + index).rgb += sum[q];
    }
}
