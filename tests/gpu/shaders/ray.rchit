#version 460
#extension GL_EXT_ray_tracing : require
layout(location = 0) rayPayloadInEXT uint payload;
void main() { payload = uint(gl_GeometryIndexEXT) * 100u + uint(gl_PrimitiveID); }
