// Makes the harmonic mean of the distances along a sample pass's links: how far away what lights a patch is,
// and so over what length its indirect light may change [Ward et al. 1988]. There is one workgroup per chunk
// and one invocation per patch.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/preamble.glsl"
layout(push_constant, scalar) uniform Push { LinkDistancePush push; };

layout(local_size_x = 64) in;

void main() {
    uint chunk = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    if (chunk >= push.chunkCount) return;
    uint lane = gl_LocalInvocationID.x, index = (push.firstChunk + chunk) * kChunk + lane;
    vec3 own = loadPatch(push.receivers, index).position;
    float sum = 0.0;
    for (uint k = 0u; k < push.sampleCount; ++k) {
        uint link = WORD_AT(push.links, (chunk * push.sampleCount + k) * kChunk + lane);
        if (link >= kLinkFirstSpecial) continue; // nothing, or what sends no light
        vec3 end = link < push.patchCount ? loadPatch(push.patches, link).position
                                          : PyramidNodes(push.nodes).items[link - push.patchCount].position;
        vec3 d = end - own;
        sum += inversesqrt(max(dot(d, d), 1e-30));
    }
    FLOAT_AT(push.distances, index) = sum > 0.0 ? float(push.sampleCount) / sum : 1e30;
}
