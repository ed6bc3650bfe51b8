// CVM pass: draws every triangle along the axis that it faces most, as a rectangle around it that holds the
// centre of each pixel the triangle touches; the fragments find out which voxels those are. A pixel is a
// column of voxels.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/preamble.glsl"
#include "lib/rays/cvm.glsl"
layout(push_constant, scalar) uniform Push { CvmPush push; };
#define geometry push.geometry

layout(location = 0) flat out vec3 corner0; // [pixels] along the picture's axes, then along its view
layout(location = 1) flat out vec3 corner1;
layout(location = 2) flat out vec3 corner2;
layout(location = 3) flat out uvec2 id; // triangle, axis

layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer VoxelGrids { VoxelGrid items[]; };

// It is half a pixel's diagonal, and two steps of the rasterizer's grid of at most 1/16 pixel (its guaranteed
// precision).
const float kGrow = 0.7072 + 0.125;

void main() {
    VoxelGrid grid = VoxelGrids(geometry.accel).items[0];
    uint triangle = push.firstTriangle + uint(gl_VertexIndex) / 6u;
    vec3 scale = grid.scale * (push.rtrad != 0u ? rtradPixelsPerVoxel(grid.resolution) : 1.0);
    vec3 p[3];
    for (uint k = 0u; k < 3u; ++k)
        p[k] = (Vec3s(geometry.triangles).items[triangle * 3u + k] - grid.origin) * scale;
    uint axis = dominantAxis(cross(p[1] - p[0], p[2] - p[0]));
    for (uint k = 0u; k < 3u; ++k) p[k] = alongAxis(p[k], axis);

    // The rectangle lies along the longest edge as seen in the picture: it has at most twice the triangle's
    // area, however thin that is.
    vec2 edge = vec2(1.0, 0.0);
    float longest = 0.0;
    for (uint k = 0u; k < 3u; ++k) {
        vec2 e = p[(k + 1u) % 3u].xy - p[k].xy;
        if (dot(e, e) > longest) {
            longest = dot(e, e);
            edge = e * inversesqrt(longest);
        }
    }
    vec2 across = vec2(-edge.y, edge.x), lo = vec2(1e30), hi = vec2(-1e30);
    for (uint k = 0u; k < 3u; ++k) {
        vec2 at = vec2(dot(p[k].xy, edge), dot(p[k].xy, across));
        lo = min(lo, at - kGrow);
        hi = max(hi, at + kGrow);
    }
    uint corner = uint(gl_VertexIndex) % 6u; // two triangles: 0 1 2, 2 1 3
    corner = corner < 3u ? corner : corner == 3u ? 2u : corner == 4u ? 1u : 3u;
    vec2 at = vec2((corner & 1u) != 0u ? hi.x : lo.x, (corner & 2u) != 0u ? hi.y : lo.y);

    corner0 = p[0];
    corner1 = p[1];
    corner2 = p[2];
    id = uvec2(triangle, axis);
    gl_Position = vec4((edge * at.x + across * at.y) * (2.0 / float(grid.resolution)) - 1.0, 0.0, 1.0);
}
