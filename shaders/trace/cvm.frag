// CVM pass: sets the voxels of one column that a triangle touches, or stores their patches.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/preamble.glsl"
#include "lib/rays/cvm.glsl"
layout(push_constant, scalar) uniform Push { CvmPush push; };
#define geometry push.geometry
#include "lib/rays/masked.glsl"

layout(location = 0) flat in vec3 corner0;
layout(location = 1) flat in vec3 corner1;
layout(location = 2) flat in vec3 corner2;
layout(location = 3) flat in uvec2 id; // triangle, axis

layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer VoxelGrids { VoxelGrid items[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer HitTriangles { HitTriangle items[]; };
VoxelGrid grid = VoxelGrids(geometry.accel).items[0];

uint texelPatch(uint texel) { return WORD_AT(push.texelToPatch, texel); }
uint chartOfPatch(uint index) { return WORD_AT(push.patchChart, index); }
#include "lib/rays/hit.glsl"

uint voxelIndex(uvec3 v) { return (v.z * grid.resolution + v.y) * grid.resolution + v.x; }

void setVoxel(uvec3 v) {
    uint i = voxelIndex(v);
    atomicOr(WORD_AT(grid.bits, i >> 5), 1u << (i & 31u));
}

// The lowest patch of each side stays, so that the order of the fragments does not matter.
void storePatch(uvec3 v, VoxelTriangle t, vec2 centre) {
    uint i = voxelIndex(v), word = WORD_AT(grid.bits, i >> 5);
    uint rank = WORD_AT(grid.ranks, i >> 5) + uint(bitCount(word & ((1u << (i & 31u)) - 1u)));
    HitTriangle hit = HitTriangles(push.hitTriangles).items[id.x];
    vec2 weights = cornerWeights(t, centre);
    uint link = hit.representative == kNoPatch ? kLinkDark : patchAtHit(hit, weights.x, weights.y, push.size);
    uint side = id.y * 2u + (hit.normal[id.y] < 0.0 ? 1u : 0u);
    atomicMin(WORD_AT(grid.patches, rank * kVoxelSides + side), link);
    if (hit.doubleSided != 0u) atomicMin(WORD_AT(grid.patches, rank * kVoxelSides + (side ^ 1u)), kLinkDark);
}

// Tells whether a triangle is solid in this column: a masked one blocks if it is solid at one of 4 x 4 points
// of the pixel, moved onto the triangle.
bool solidInPixel(VoxelTriangle t, vec2 centre) {
    if (id.x < geometry.opaqueCount) return true;
    for (int k = 0; k < 16; ++k) {
        // The point is moved off the very edge, where a repeated texture begins anew.
        vec2 weights = mix(cornerWeights(t, centre + vec2(k & 3, k >> 2) * 0.25 - 0.375), vec2(1.0 / 3.0), 0.01);
        if (solidHit(id.x, weights.x, weights.y)) return true;
    }
    return false;
}

// Follows RTRad's rule: one voxel is set per pixel that the triangle touches, that of the position
// interpolated to the pixel's centre, however far outside the triangle it lies. Its rasterizer interpolates
// between corners snapped to 1/256 pixel, which sends small triangles' positions astray.
void rtradVoxel(VoxelTriangle t, vec2 centre) {
    VoxelTriangle snapped = t;
    snapped.a.xy = round(t.a.xy * 256.0) / 256.0;
    snapped.b.xy = round(t.b.xy * 256.0) / 256.0;
    snapped.c.xy = round(t.c.xy * 256.0) / 256.0;
    if (!touchesPixel(snapped, centre)) return;
    vec2 e = snapped.b.xy - snapped.a.xy, f = snapped.c.xy - snapped.a.xy, d = centre - snapped.a.xy;
    float det = e.x * f.y - e.y * f.x;
    if (det == 0.0) return;
    vec3 p = t.a + (t.b - t.a) * ((d.x * f.y - d.y * f.x) / det) + (t.c - t.a) * ((e.x * d.y - e.y * d.x) / det);
    uvec3 v = uvec3(max(fromAxis(p, id.y) / rtradPixelsPerVoxel(grid.resolution), vec3(0.0)));
    if (all(lessThan(v, uvec3(grid.resolution)))) setVoxel(v);
}

void main() {
    VoxelTriangle t = voxelTriangle(corner0, corner1, corner2);
    vec2 centre = floor(gl_FragCoord.xy) + 0.5;
    if (push.rtrad != 0u) {
        rtradVoxel(t, centre);
        return;
    }
    vec2 range = columnRange(t, centre);
    int first = max(0, int(floor(range.x))), last = min(int(grid.resolution) - 1, int(floor(range.y)));
    if (first > last || !solidInPixel(t, centre)) return;
    for (int z = first; z <= last; ++z) {
        vec3 middle = vec3(centre, float(z) + 0.5);
        if (!touchesVoxel(t, middle)) continue;
        uvec3 v = uvec3(fromAxis(middle, id.y));
        if (push.patches != 0u) storePatch(v, t, centre);
        else setVoxel(v);
    }
}
