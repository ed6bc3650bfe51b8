// The points that samples start from: all over the part of the texel that the patch's surface covers. It is
// legal as GLSL and as C++ (namespace relume::shader); it comes after lib/sampling.glsl.

// The salt keeps the numbers of points apart from those of directions, which start from the same seeds.
CONST uint kStartSalt = 0x3c6ef372u;

// Returns the number of a sample: of target `target` of sample pass `samplePass`. Targets come in turns of `turn`,
// one for each light; in a turn, runs of `run` targets belong to the replicates one after the other.
FUNCTION uint startNumber(uint target, uint samplePass, uint turn, uint run) {
    uint t = target % turn, which = t / run;
    return samplePass * turn + (which / kReplicates * run + t % run) * kReplicates + which % kReplicates;
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

// The places that tell whether a point may lie anywhere in a texel: corners and middles of edges.
CONST uint kRimPlaces = 8u;
FUNCTION vec2 rimPlace(uint index) {
    uint place = index < kRimPlaces / 2u ? index : index + 1u; // all of 3 x 3 but the middle
    return 0.5f * vec2(float(place % 3u), float(place / 3u));
}

// Returns where a segment ends [m] by which patch p asks whether its own point sees a place in the texel; w = 1, or 0
// where the place is so near to that point that there is nothing to ask.
FUNCTION vec4 placeTarget(Patch p, PatchCover c, vec2 place) {
    const float kHere = 1e-3f; // of the texel
    vec3 way = coverWay(c, place);
    if (length(way) <= kHere * (length(c.du) + length(c.dv))) return vec4(0.0f);
    return vec4(p.position + way + p.offset * p.normal, 1.0f);
}

// Returns the point that sample `number` of patch p starts from [m], on the patch's plane.
FUNCTION vec3 startPoint(Patch p, PatchCover c, uint number) {
    if (c.cells == 0u) return p.position;
    vec2 u = sobolPoint(replicateIndex(number), startSeed(replicateSeed(seedKey(p), number)));
    return p.position + coverWay(c, (c.cells & kCoverWhole) != 0u ? u : coverCell(c.cells, u.x));
}
