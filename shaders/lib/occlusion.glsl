// One 32-bit word of visibility: patch `lane` of the unit's row chunk against 32 patches of its column chunk.
void traceWord(uint unit, uint word, uint lane) {
    uvec2 pair = UVec2s(push.supers).items[unit / kSuperBlocks];
    uint row = pair.x * kSuper + (unit % kSuperBlocks) / kSuper;
    uint column = pair.y * kSuper + unit % kSuper;
    if (row > column || column >= push.chunkCount) return;
    Words sends = Words(push.chunkSends);
    if (sends.items[row] == 0u && sends.items[column] == 0u) return;

    uint receiver = row * kChunk + lane;
    uint first = column * kChunk + word * 32u;
    Patch a = loadPatch(push.patches, receiver);
    uint facing = 0u;
    for (uint j = 0u; j < 32u; ++j) {
        Patch b = loadPatch(push.patches, first + j);
        if (first + j > receiver && pairFaces(a, b)) facing |= 1u << j;
    }
#ifdef TRACER_VOXEL
    uint marched = 0u; // bits that are not another tracer's
    for (uint j = 0u; j < 32u; ++j) {
        Patch sender = push.reversed != 0u ? a : loadPatch(push.patches, first + j);
        if (voxelsServe(sender)) marched |= 1u << j;
    }
    facing &= marched;
#endif
    if (facing != 0u) atomicAdd(Words(push.rays).items[unit % kRayCounters], uint(bitCount(facing)));
    uint seen = 0u;
    while (facing != 0u) {
        int j = findLSB(facing);
        facing &= facing - 1u;
        Patch b = loadPatch(push.patches, first + uint(j));
        bool rtrad = push.rtrad != 0u;
        if (push.reversed != 0u ? patchesSee(b, a, rtrad) : patchesSee(a, b, rtrad)) seen |= 1u << j;
    }
    uint at = (unit % push.bitsUnits) * kBlockWords + lane * 2u + word;
#ifdef TRACER_VOXEL
    if (grid.ratio > 1u) seen |= Words(push.bits).items[at] & ~marched;
#endif
    Words(push.bits).items[at] = seen;
}
