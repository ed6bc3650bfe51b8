// The alpha test of a hit on a masked triangle (index in WorldMesh order). It reads `geometry`, a
// TraceGeometry.
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer AlphaTriangles { AlphaTriangle items[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer AlphaMaterials { AlphaMaterial items[]; };

float alphaTexel(uint offset) {
    uint word = Words(geometry.alphaTexels).items[offset >> 2];
    return float((word >> (8u * (offset & 3u))) & 255u) / 255.0;
}
#include "lib/rays/alpha.glsl"

bool solidHit(uint triangle, float b1, float b2) {
    AlphaTriangle t = AlphaTriangles(geometry.alphaTriangles).items[triangle - geometry.opaqueCount];
    return alphaSolid(t, AlphaMaterials(geometry.alphaMaterials).items[t.material], b1, b2);
}
