// CIT pass: draws every triangle at its place in the lightmap. Vertices are pulled by address.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/preamble.glsl"
layout(push_constant, scalar) uniform Push { CitPush push; };

layout(location = 0) out vec3 bary;       // outside [0,1] where the triangle was grown
layout(location = 1) out vec2 pixel;      // [texels]
layout(location = 2) flat out uint triangle;
layout(location = 3) flat out uint grown;
layout(location = 4) flat out vec4 pixelBounds; // of the triangle, lo and hi [texels]

// Returns the corner of the triangle whose edges are moved outwards so far that every texel they touch has
// its centre inside [Hasselgren, Akenine-Moeller and Ohlsson 2005]. Distances are in texels.
vec2 grownCorner(vec2 a, vec2 b, vec2 c) {
    float winding = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x) >= 0.0 ? 1.0 : -1.0;
    vec2 e0 = (b - a) * winding, e1 = (a - c) * winding; // both edges at corner a
    vec2 n0 = vec2(e0.y, -e0.x), n1 = vec2(e1.y, -e1.x); // outwards
    float d0 = dot(n0, a) + 0.5 * (abs(n0.x) + abs(n0.y)), d1 = dot(n1, a) + 0.5 * (abs(n1.x) + abs(n1.y));
    float det = n0.x * n1.y - n0.y * n1.x;
    if (abs(det) < 1e-12) return a;
    return vec2(d0 * n1.y - n0.y * d1, n0.x * d1 - d0 * n1.x) / det;
}

void main() {
    uint drawn = uint(gl_VertexIndex) / 3u;
    bool grow = drawn < push.grownCount;
    triangle = grow ? drawn : drawn - push.grownCount;
    grown = grow ? 1u : 0u;
    uint corner = uint(gl_VertexIndex) % 3u;
    Vec2s uvs = Vec2s(push.lightmapUv);
    vec2 p[3];
    for (uint k = 0u; k < 3u; ++k) p[k] = uvs.items[triangle * 3u + k] * float(push.size);
    pixelBounds = vec4(min(p[0], min(p[1], p[2])), max(p[0], max(p[1], p[2])));
    pixel = p[corner];
    bary = vec3(corner == 0u, corner == 1u, corner == 2u);
    if (grow) {
        pixel = grownCorner(p[corner], p[(corner + 1u) % 3u], p[(corner + 2u) % 3u]);
        vec2 e1 = p[1] - p[0], e2 = p[2] - p[0], q = pixel - p[0];
        float det = e1.x * e2.y - e1.y * e2.x;
        if (det != 0.0) {
            bary.y = (q.x * e2.y - q.y * e2.x) / det;
            bary.z = (e1.x * q.y - e1.y * q.x) / det;
            bary.x = 1.0 - bary.y - bary.z;
        }
    }
    // Row 0 of the lightmap is v = 0, as in Vulkan's framebuffer.
    gl_Position = vec4(pixel * (2.0 / float(push.size)) - 1.0, 0.0, 1.0);
}
