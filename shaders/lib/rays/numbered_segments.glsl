// Traces the segments from a chunk's patches to 32 targets of each, by a workgroup of one invocation per patch. Many
// targets want no ray, so those that do are numbered through, target by target, and each invocation takes the next one
// until none is left: else most lanes of a GPU wait for the few whose target is a ray. Numbers are looked up in bits
// and not in a list, because a GPU takes shared memory from the cache that it reads the tree through: with a list of
// 8 KiB the rays of a hall took 22 % longer on an NVIDIA H200.
#include "lib/rays/starts.glsl"
#define LISTED_INSTEAD push.patches
#include "lib/listed_chunk.glsl"

const uint kTargetsPerWord = 32u;

shared uint targetBits[kChunk];              // per patch: which targets want a ray, and then which are seen
shared uvec2 patchBits[kTargetsPerWord];     // per target: which patches want one
shared uint firstRays[kTargetsPerWord + 1u]; // per target: the number of its first ray; behind them that of all
shared uint nextRay;

// Returns which targets of a patch want a ray; firstTarget is where in push.targets the chunk's first one is.
uint wantedTargets(uint firstTarget, uint count, uint lane) {
    uint bits = 0u;
    for (uint s = 0u; s < count; ++s)
        if (VEC4_AT(push.targets, firstTarget + s * kChunk + lane).w > 0.0) bits |= 1u << s;
    return bits;
}

// Numbers the rays that targetBits tell.
void numberRays(uint lane) {
    if (lane < kTargetsPerWord) {
        uvec2 bits = uvec2(0u);
        for (uint k = 0u; k < 32u; ++k) {
            bits.x |= bitfieldExtract(targetBits[k], int(lane), 1) << k;
            bits.y |= bitfieldExtract(targetBits[32u + k], int(lane), 1) << k;
        }
        patchBits[lane] = bits;
    }
    barrier();
    if (lane <= kTargetsPerWord) {
        uint first = 0u;
        for (uint s = 0u; s < lane; ++s) first += uint(bitCount(patchBits[s].x) + bitCount(patchBits[s].y));
        firstRays[lane] = first;
    }
}

// Returns the place of the set bit that has so many set bits below it.
uint setBit(uint bits, uint below) {
    uint place = 0u;
    for (uint width = 16u; width > 0u; width >>= 1u) {
        uint count = uint(bitCount(bitfieldExtract(bits, int(place), int(width))));
        if (below < count) continue;
        below -= count;
        place += width;
    }
    return place;
}

// Returns target * kChunk + patch of a ray.
uint placeOfRay(uint ray) {
    uint target = 0u;
    for (uint width = kTargetsPerWord / 2u; width > 0u; width >>= 1u)
        if (firstRays[target + width] <= ray) target += width;
    uint below = ray - firstRays[target];
    uvec2 bits = patchBits[target];
    uint inFirst = uint(bitCount(bits.x));
    return target * kChunk + (below < inFirst ? setBit(bits.x, below) : 32u + setBit(bits.y, below - inFirst));
}

// Makes one word of visibility of each patch of a chunk.
void traceTargets(uint chunk, uint word, uint lane) {
    uint firstPatch = listedChunk(chunk) * kChunk;
    uint first = word * kTargetsPerWord, count = min(kTargetsPerWord, push.targetCount - first);
    uint firstTarget = (chunk * push.targetCount + first) * kChunk;
    targetBits[lane] = wantedTargets(firstTarget, count, lane);
    if (lane == 0u) nextRay = 0u;
    barrier();
    numberRays(lane);
    targetBits[lane] = 0u;
    barrier();
    uint rays = firstRays[kTargetsPerWord];
    for (uint ray = atomicAdd(nextRay, 1u); ray < rays; ray = atomicAdd(nextRay, 1u)) {
        uint place = placeOfRay(ray), target = place / kChunk, patchLane = place % kChunk, index = firstPatch + patchLane;
        uint number = startNumber(first + target, push.samplePass, push.turn, push.run);
        Patch start = startingPatch(loadPatch(push.patches, index), coverOf(index), number);
        if (pointSeen(start, VEC4_AT(push.targets, firstTarget + place).xyz)) atomicOr(targetBits[patchLane], 1u << target);
    }
    barrier();
    uint words = (push.targetCount + kTargetsPerWord - 1u) / kTargetsPerWord;
    WORD_AT(push.bits, (chunk * words + word) * kChunk + lane) = targetBits[lane];
    if (lane == 0u && rays != 0u) atomicAdd(WORD_AT(push.rays, (push.firstChunk + chunk) % kRayCounters), rays);
}
