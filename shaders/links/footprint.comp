// Makes links read the light filtered: the patch that a direction hit becomes the widest part of its chart
// around it that is not wider than what the direction stands for. There is one workgroup per chunk and one
// invocation per receiver.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/preamble.glsl"
#include "lib/footprint.glsl"
layout(push_constant, scalar) uniform Push { FootprintPush push; };

layout(local_size_x = 64) in;

void main() {
    uint chunk = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    if (chunk >= push.chunkCount) return;
    uint lane = gl_LocalInvocationID.x;
    vec3 own = loadPatch(push.receivers, (push.firstChunk + chunk) * kChunk + lane).position;
    Words links = Words(push.links);
    UVec2s steps = UVec2s(push.steps);
    for (uint k = 0u; k < push.sampleCount; ++k) {
        uint at = (chunk * push.sampleCount + k) * kChunk + lane;
        uint link = WORD_AT(links, at);
        if (link >= kLinkFirstSpecial) continue;
        float area = footprintArea(own, loadPatch(push.patches, link).position, push.samples);
        for (uvec2 next = steps.items[link]; uintBitsToFloat(next.y) <= area; next = steps.items[link]) link = next.x;
        WORD_AT(links, at) = link;
    }
}
