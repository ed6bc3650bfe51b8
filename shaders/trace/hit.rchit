// The closest-hit shader of the ray tracing pipeline tells which triangle was hit, and where on it.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_ray_tracing : require
#include "lib/preamble.glsl"
struct PushStart {
    TraceGeometry geometry;
};
layout(push_constant, scalar) uniform Push { PushStart push; };

struct Hit {
    uint triangle;
    float b1, b2;
};
layout(location = 0) rayPayloadInEXT Hit hit;
hitAttributeEXT vec2 barycentrics;

void main() {
    hit.triangle = uint(gl_PrimitiveID) + (gl_GeometryIndexEXT == 1 ? push.geometry.opaqueCount : 0u);
    hit.b1 = barycentrics.x;
    hit.b2 = barycentrics.y;
}
