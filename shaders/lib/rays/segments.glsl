// Makes one word of visibility: patch `lane` of a chunk against up to 32 consecutive targets of its own. It serves
// ray pipelines, whose invocations share nothing, and voxels, which serve some targets only; lib/rays/numbered_segments.glsl
// serves the others.
#include "lib/rays/starts.glsl"
#define LISTED_INSTEAD push.patches
#include "lib/listed_chunk.glsl"

const uint kTargetsPerWord = 32u;

void traceTargets(uint chunk, uint word, uint lane) {
    uint index = listedChunk(chunk) * kChunk + lane;
    Patch p = loadPatch(push.patches, index);
    PatchCover cover = coverOf(index);
    uint first = word * kTargetsPerWord, count = min(kTargetsPerWord, push.targetCount - first);
    uint seen = 0u, rays = 0u;
#ifdef TRACER_VOXEL
    uint marched = 0u; // bits that are not another tracer's
#endif
    for (uint s = 0u; s < count; ++s) {
        vec4 target = VEC4_AT(push.targets, (chunk * push.targetCount + first + s) * kChunk + lane);
#ifdef TRACER_VOXEL
        if (!voxelsServeTarget(first + s)) continue;
        marched |= 1u << s;
#endif
        if (target.w <= 0.0) continue;
        ++rays;
        Patch start = startingPatch(p, cover, startNumber(first + s, push.samplePass, push.turn, push.run));
        if (pointSeen(start, target.xyz)) seen |= 1u << s;
    }
    if (rays != 0u) atomicAdd(WORD_AT(push.rays, (push.firstChunk + chunk) % kRayCounters), rays);
    uint words = (push.targetCount + kTargetsPerWord - 1u) / kTargetsPerWord;
    uint at = (chunk * words + word) * kChunk + lane;
#ifdef TRACER_VOXEL
    if (grid.ratio > 1u) seen |= WORD_AT(push.bits, at) & ~marched;
#endif
    WORD_AT(push.bits, at) = seen;
}
