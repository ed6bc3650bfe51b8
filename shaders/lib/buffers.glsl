// Buffers by device address. Structs of whole 16-byte rows are read as rows of four words: one wide load each.
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer Rows { uvec4 items[]; };
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Vec4s { vec4 items[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer Vec3s { vec3 items[]; };
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer Vec2s { vec2 items[]; };
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer UVec2s { uvec2 items[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Words { uint items[]; };

Patch loadPatch(ADDRESS patches, uint index) {
    Rows rows = Rows(patches);
    uvec4 a = rows.items[index * 3u], b = rows.items[index * 3u + 1u], c = rows.items[index * 3u + 2u];
    Patch p;
    p.position = uintBitsToFloat(a.xyz);
    p.offset = uintBitsToFloat(a.w);
    p.normal = uintBitsToFloat(b.xyz);
    p.area = uintBitsToFloat(b.w);
    p.shading = uintBitsToFloat(c.xyz);
    p.flags = c.w;
    return p;
}
