// The miss shader of the ray tracing pipeline.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_ray_tracing : require
#include "lib/preamble.glsl"

struct Hit {
    uint triangle;
    float b1, b2;
};
layout(location = 0) rayPayloadInEXT Hit hit;

void main() { hit.triangle = kNoPatch; }
