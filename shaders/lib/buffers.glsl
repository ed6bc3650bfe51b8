// Buffers by device address. Structs of whole 16-byte rows are read as rows of four words: one wide load
// each.
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer Rows { uvec4 items[]; };
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Vec4s { vec4 items[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer Vec3s { vec3 items[]; };
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer Vec2s { vec2 items[]; };
layout(buffer_reference, scalar, buffer_reference_align = 8) buffer UVec2s { uvec2 items[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Words { uint items[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Floats { float items[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer PyramidNodes { PyramidNode items[]; };

// An element of an array that may be larger than 4 GiB: a driver may compute items[index] with an offset of 32
// bits. `array` is an address, or a buffer.
#define VEC4_AT(array, index) Vec4s(uint64_t(array) + 16ul * uint64_t(index)).items[0]
#define UVEC2_AT(array, index) UVec2s(uint64_t(array) + 8ul * uint64_t(index)).items[0]
#define WORD_AT(array, index) Words(uint64_t(array) + 4ul * uint64_t(index)).items[0]
#define FLOAT_AT(array, index) Floats(uint64_t(array) + 4ul * uint64_t(index)).items[0]
// Returns an element of an array that may not be there (address 0); else `otherwise`. Mesa 26's software device reads ahead
// of a condition what is read behind it. So there something is read in any case: the beginning of `instead`, which is
// there. A GPU would wait for it.
layout(constant_id = 100) const bool kSoftwareDevice = false;
bool readsAny(ADDRESS array) { return kSoftwareDevice || array != 0ul; }
ADDRESS readable(ADDRESS array, ADDRESS instead) { return !kSoftwareDevice || array != 0ul ? array : instead; }
uint readableAt(ADDRESS array, uint index) { return !kSoftwareDevice || array != 0ul ? index : 0u; }
uint wordIfAny(ADDRESS array, uint index, ADDRESS instead, uint otherwise) {
    uint value = otherwise;
    if (readsAny(array)) value = WORD_AT(readable(array, instead), readableAt(array, index));
    return array != 0ul ? value : otherwise;
}
vec2 vec2IfAny(ADDRESS array, uint index, ADDRESS instead, vec2 otherwise) {
    vec2 value = otherwise;
    if (readsAny(array)) value = Vec2s(readable(array, instead)).items[readableAt(array, index)];
    return array != 0ul ? value : otherwise;
}
vec4 vec4IfAny(ADDRESS array, uint index, ADDRESS instead) {
    vec4 value = vec4(0.0);
    if (readsAny(array)) value = VEC4_AT(readable(array, instead), readableAt(array, index));
    return array != 0ul ? value : vec4(0.0);
}

Rows rowsAt(ADDRESS array, uint index, uint count) { return Rows(array + 16ul * uint64_t(count) * uint64_t(index)); }

Patch patchOfRows(uvec4 a, uvec4 b, uvec4 c) {
    Patch p;
    p.position = uintBitsToFloat(a.xyz);
    p.offset = uintBitsToFloat(a.w);
    p.normal = uintBitsToFloat(b.xyz);
    p.area = uintBitsToFloat(b.w);
    p.shading = uintBitsToFloat(c.xyz);
    p.flags = c.w;
    return p;
}

Patch loadPatch(ADDRESS patches, uint index) {
    Rows rows = rowsAt(patches, index, 3u);
    return patchOfRows(rows.items[0], rows.items[1], rows.items[2]);
}

// Does the same where all pairs of patches are looked at, which are never so many that offsets need more than 32
// bits: a GPU traces a fifth more pairs by these.
Patch loadPairedPatch(ADDRESS patches, uint index) {
    Rows rows = Rows(patches);
    return patchOfRows(rows.items[index * 3u], rows.items[index * 3u + 1u], rows.items[index * 3u + 2u]);
}

PatchCover loadCover(ADDRESS covers, uint index) {
    Rows rows = rowsAt(covers, index, 2u);
    uvec4 a = rows.items[0], b = rows.items[1];
    PatchCover c;
    c.du = uintBitsToFloat(a.xyz);
    c.cells = a.w;
    c.dv = uintBitsToFloat(b.xyz);
    c.place = b.w;
    return c;
}

EmitterPolygon loadEmitterPolygon(ADDRESS polygons, uint index) {
    Rows rows = Rows(polygons);
    uvec4 a = rows.items[index * 5u], b = rows.items[index * 5u + 1u], c = rows.items[index * 5u + 2u];
    uvec4 d = rows.items[index * 5u + 3u], r = rows.items[index * 5u + 4u];
    EmitterPolygon e;
    e.c0 = uintBitsToFloat(a.xyz);
    e.area = uintBitsToFloat(a.w);
    e.c1 = uintBitsToFloat(b.xyz);
    e.offset = uintBitsToFloat(b.w);
    e.c2 = uintBitsToFloat(c.xyz);
    e.split = uintBitsToFloat(c.w);
    e.c3 = uintBitsToFloat(d.xyz);
    e.shape = d.w;
    e.radiance = uintBitsToFloat(r.xyz);
    e.triangle = r.w;
    return e;
}

EmitterEdge loadEmitterEdge(ADDRESS edges, uint index) {
    Rows rows = Rows(edges);
    uvec4 a = rows.items[index * 4u], b = rows.items[index * 4u + 1u], c = rows.items[index * 4u + 2u];
    uvec4 d = rows.items[index * 4u + 3u];
    EmitterEdge e;
    e.from = uintBitsToFloat(a.xyz);
    e.height = uintBitsToFloat(a.w);
    e.along = uintBitsToFloat(b.xyz);
    e.heightBeyond = uintBitsToFloat(b.w);
    e.normal = uintBitsToFloat(c.xyz);
    e.polygon = c.w;
    e.normalBeyond = uintBitsToFloat(d.xyz);
    e.polygonBeyond = d.w;
    return e;
}

EmitterNode loadEmitterNode(ADDRESS nodes, uint index) {
    Rows rows = Rows(nodes);
    uvec4 a = rows.items[index * 3u], b = rows.items[index * 3u + 1u], c = rows.items[index * 3u + 2u];
    EmitterNode e;
    e.lo = uintBitsToFloat(a.xyz);
    e.power = uintBitsToFloat(a.w);
    e.hi = uintBitsToFloat(b.xyz);
    e.cosCone = uintBitsToFloat(b.w);
    e.axis = uintBitsToFloat(c.xyz);
    e.link = c.w;
    return e;
}
