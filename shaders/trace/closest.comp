// Finds closest hits, with one workgroup per chunk (x) and eight samples (y).
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/preamble.glsl"
#include "lib/pairs.glsl"
#include "lib/sampling.glsl"
layout(push_constant, scalar) uniform Push { ClosestPush push; };
#define geometry push.geometry
#include "lib/rays/trace.glsl"
#include "lib/rays/closest.glsl"

// With 1 a workgroup's rays are sorted by direction first, so that neighbouring lanes take neighbouring ways
// (GPUs); with 0 there is one invocation per patch (software devices, where barriers cost more than that
// gains).
layout(constant_id = 0) const uint kSorted = 1;

layout(local_size_x = 64) in;

const uint kCellBits = 3u; // cells along an edge of the unit square that directions come from: 2^3
const uint kCells = 1u << (2u * kCellBits);
shared uint cellEnd[kCells];
shared uint order[kSamplesPerInvocation * kChunk];

// Cells are in Morton order, so that neighbouring cells mostly follow each other.
uint cellOf(uint key, uint index) {
    vec2 u = push.discCount == 0u ? directionPoint(key, index) : 0.4999 * discSample(key, index).xy + 0.5;
    uvec2 c = uvec2(u * float(1u << kCellBits));
    c = (c | (c << 2u)) & 0x13u;
    c = (c | (c << 1u)) & 0x15u;
    return c.x | (c.y << 1u);
}

void main() {
    uint chunk = gl_WorkGroupID.x, lane = gl_LocalInvocationID.x;
#ifdef TRACER_VOXEL
    const bool sorted = false; // a march through voxels takes about as long whichever way it goes
#else
    const bool sorted = kSorted != 0u && push.rotation != kRotateTile;
#endif
    if (!sorted) {
        traceLinks(chunk, gl_WorkGroupID.y, lane);
        return;
    }
    uint firstPatch = (push.firstChunk + chunk) * kChunk, firstLocal = gl_WorkGroupID.y * kSamplesPerInvocation;
    // Directions are not shared by tile here: the first patch has no say.
    Patch own = loadPatch(push.patches, firstPatch + lane);
    uint ownKey = rotationKey(own, own, push.rotation, push.size);
    // This is a counting sort. The order within a cell is open, but every link has a place of its own.
    for (uint c = lane; c < kCells; c += kChunk) cellEnd[c] = 0u;
    barrier();
    for (uint k = 0u; k < kSamplesPerInvocation; ++k) atomicAdd(cellEnd[cellOf(ownKey, push.firstSample + firstLocal + k)], 1u);
    barrier();
    if (lane == 0u) {
        uint sum = 0u;
        for (uint c = 0u; c < kCells; ++c) {
            uint count = cellEnd[c];
            cellEnd[c] = sum;
            sum += count;
        }
    }
    barrier();
    for (uint k = 0u; k < kSamplesPerInvocation; ++k) {
        uint slot = atomicAdd(cellEnd[cellOf(ownKey, push.firstSample + firstLocal + k)], 1u);
        order[slot] = k * kChunk + lane;
    }
    barrier();
    for (uint t = 0u; t < kSamplesPerInvocation; ++t) {
        uint which = order[t * kChunk + lane], local = firstLocal + which / kChunk, other = which % kChunk;
        Patch p = loadPatch(push.patches, firstPatch + other);
        uint key = rotationKey(p, p, push.rotation, push.size);
        uint link = linkOfSample(p, coverOf(firstPatch + other), key, push.firstSample + local);
        WORD_AT(push.links, (chunk * push.sampleCount + local) * kChunk + other) = link;
    }
}
