// Makes one 32-bit word of visibility: patch `lane` of the unit's row chunk against 32 senders of its column
// chunk.
#include "lib/supers.glsl"
#include "lib/senders.glsl"

bool unitAsked(SuperBlock super, uint row, uint column, uint local) {
    if (row >= push.rowCount || column >= push.columnCount || unitKnown(super, local)) return false;
    Words sends = Words(push.sends);
    if (sends.items[column] != 0u) return push.senders != 0ul || row <= column;
    return push.senders == 0ul && row <= column && sends.items[row] != 0u;
}

// Returns the patch that sender `index` is for this row of receivers; kNoPatch for padding.
uint columnPatch(uint index, uint rowKey) {
    return push.senders == 0ul ? index : drawnMember(push.senders, push.members, index, rowKey);
}

void traceWord(uint unit, uint word, uint lane) {
    SuperBlock super = loadSuper(push.supers, unit / kSuperBlocks);
    uint local = unit % kSuperBlocks;
    uint row = super.row * kSuper + local / kSuper;
    uint column = super.column * kSuper + local % kSuper;
    if (!unitAsked(super, row, column, local)) return;

    bool symmetric = push.senders == 0ul;
    uint receiver = row * kChunk + lane;
    uint first = column * kChunk + word * 32u;
    uint rowKey = symmetric ? 0u : chunkKey(push.patches, row);
    Patch a = loadPairedPatch(push.patches, receiver);
    uint facing = 0u;
    for (uint j = 0u; j < 32u; ++j) {
        uint sender = columnPatch(first + j, rowKey);
        if (sender == kNoPatch) continue;
        Patch b = loadPairedPatch(push.patches, sender);
        if ((!symmetric || sender > receiver) && pairFaces(a, b)) facing |= 1u << j;
    }
    bool rtrad = (push.flags & kOcclusionRtrad) != 0u, reversed = (push.flags & kOcclusionReversed) != 0u;
#ifdef TRACER_VOXEL
    uint marched = 0u; // bits that are not another tracer's
    for (uint j = 0u; j < 32u; ++j) {
        uint sender = columnPatch(first + j, rowKey);
        if (reversed ? voxelsServe(a) : sender != kNoPatch && voxelsServe(loadPairedPatch(push.patches, sender)))
            marched |= 1u << j;
    }
    facing &= marched;
#endif
    if (facing != 0u) {
        uint slot = super.counters + unit % kRayCounters;
        atomicAdd(Words(push.rays).items[slot], uint(bitCount(facing)));
    }
    uint seen = 0u;
    // Lanes go sender by sender, though some then wait: neighbours' rays to one sender take the same way.
    for (uint j = 0u; j < 32u; ++j) {
        if ((facing >> j & 1u) == 0u) continue;
        uint sender = columnPatch(first + j, rowKey);
        Patch b = loadPairedPatch(push.patches, sender);
        // The ray starts at the lower index, whichever end asks; RTRad's rays start at the receiver.
        bool turned = rtrad ? reversed : sender < receiver;
        if (turned ? patchesSee(b, a, rtrad) : patchesSee(a, b, rtrad)) seen |= 1u << j;
    }
    uint at = (reversed ? kSuperWords : 0u) + local * kBlockWords + lane * 2u + word;
#ifdef TRACER_VOXEL
    if (grid.ratio > 1u) seen |= Words(super.bits).items[at] & ~marched;
#endif
    Words(super.bits).items[at] = seen;
}
