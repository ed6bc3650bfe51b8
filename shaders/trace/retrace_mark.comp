// Lists links that are to be traced again. There is one workgroup per chunk (x) and eight samples (y), and
// one invocation per patch.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/preamble.glsl"
#include "lib/sampling.glsl"
#include "shared_objects.h"
#include "lib/rays/boxes.glsl"
layout(push_constant, scalar) uniform Push { RetraceMarkPush push; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer Boxes { TraceBox items[]; };

#include "lib/rays/starts.glsl"

layout(local_size_x = 64) in;

const uint kSamplesPerInvocation = 8u;

uvec2 patchBits(uint64_t all, uint chunk) { return uvec2(WORD_AT(all, chunk * 2u), WORD_AT(all, chunk * 2u + 1u)); }

void list(uint marks, uint base) {
    if (marks == 0u) return;
    uint at = atomicAdd(WORD_AT(push.list, 0), uint(bitCount(marks)));
    for (; marks != 0u; marks &= marks - 1u)
        WORD_AT(push.list, 1u + at++) = base + uint(findLSB(marks)) * kChunk;
}

void main() {
    uint chunk = gl_WorkGroupID.x, lane = gl_LocalInvocationID.x, firstLocal = gl_WorkGroupID.y * kSamplesPerInvocation;
    uint first = (push.firstChunk + chunk) * kChunk;
    Patch p = loadPatch(push.patches, first + lane);
    uint base = (chunk * push.sampleCount + firstLocal) * kChunk + lane;
    bool asks = asksAgain(p, push.silent);
    uint marks = 0u;
    if (hasPatch(patchBits(push.changed, push.firstChunk + chunk), lane)) {
        marks = (1u << kSamplesPerInvocation) - 1u;
    } else if (asks) {
        for (uint k = 0u; push.ends != 0ul && k < kSamplesPerInvocation; ++k) {
            uint link = WORD_AT(push.links, base + k * kChunk);
            if (link < kLinkFirstSpecial && hasPatch(patchBits(push.ends, link / kChunk), link % kChunk)) marks |= 1u << k;
        }
        uint key = rotationKey(p, loadPatch(push.patches, first), push.rotation, push.size);
        PatchCover cover = coverOf(first + lane);
        bool above = false;
        for (uint b = 0u; b < push.boxCount; ++b) above = above || boxAbove(p.position, p.normal, Boxes(push.boxes).items[b]);
        for (uint k = 0u; above && k < kSamplesPerInvocation; ++k) {
            uint number = push.firstSample + firstLocal + k;
            vec3 origin = startingPatch(p, cover, number).position + p.offset * p.normal;
            vec3 direction = patchDirection(p, key, number);
            bool meets = false;
            for (uint b = 0u; b < push.boxCount; ++b)
                meets = meets || rayMeetsBox(origin, direction, Boxes(push.boxes).items[b]);
            if (meets) marks |= 1u << k;
        }
    }
    list(marks, base);
    if (marks != 0u && asks)
        atomicAdd(WORD_AT(push.rays, (push.firstChunk + chunk) % kRayCounters), uint(bitCount(marks)));
}
