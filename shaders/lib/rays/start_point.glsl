// The points that samples start from: all over the part of the texel that the patch's surface covers. It is
// legal as GLSL and as C++ (namespace relume::shader); it comes after lib/sampling.glsl.

// The salt keeps the numbers of points apart from those of directions, which start from the same seeds.
CONST uint kStartSalt = 0x3c6ef372u;

// Returns the number of a sample: of target `target` of sample pass `round`. Targets come in turns of `turn`,
// one for each light; in a turn, runs of `run` targets belong to the replicates one after the other.
FUNCTION uint startNumber(uint target, uint round, uint turn, uint run) {
    uint t = target % turn, which = t / run;
    return round * turn + (which / kReplicates * run + t % run) * kReplicates + which % kReplicates;
}

FUNCTION uint startSeed(uint replicate) { return hash32(replicate ^ kStartSalt); }

// Returns the middle of a cell, in [0, 1]^2.
FUNCTION vec2 cellPlace(uint cell) {
    return vec2(float(cell % kCoverEdge) + 0.5f, float(cell / kCoverEdge) + 0.5f) * (1.0f / float(kCoverEdge));
}

// Returns the middle of one of the cells that are set; u in [0, 1) says which.
FUNCTION vec2 coverCell(uint cells, float u) {
    uint rest = cells & kCoverCells;
    uint count = uint(bitCount(rest));
    uint skip = min(uint(u * float(count)), count - 1u);
    for (uint k = 0u; k < skip; ++k) rest &= rest - 1u;
    return cellPlace(uint(findLSB(rest)));
}

// Returns how far a place in the texel, in [0, 1]^2, lies from the patch's own point [m].
FUNCTION vec3 coverWay(PatchCover c, vec2 place) {
    const float kUnit = 1.0f / float(kCoverPlaces);
    return (place.x - float(c.place & 0xffffu) * kUnit) * c.du + (place.y - float(c.place >> 16) * kUnit) * c.dv;
}

// Returns the point that sample `number` of patch p starts from [m], on the patch's plane.
FUNCTION vec3 startPoint(Patch p, PatchCover c, uint number) {
    if (c.cells == 0u) return p.position;
    vec2 u = sobolPoint(replicateIndex(number), startSeed(replicateSeed(seedKey(p), number)));
    return p.position + coverWay(c, (c.cells & kCoverWhole) != 0u ? u : coverCell(c.cells, u.x));
}
