// Tells how far each receiver of the coarser grid is from what its neighbours on both sides say, without what
// noise explains: squares of the light's difference along rows of texels in x, how many were compared in y,
// along columns in z and w. These are sums over chunks of receivers. There is one workgroup per chunk.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/preamble.glsl"
layout(push_constant, scalar) uniform Push { CoarseErrorPush push; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer Neighbours { CoarseNeighbours items[]; };

layout(local_size_x = 64) in;

shared vec4 terms[kChunk];

vec3 light(uint q, uint index) { return push.scale * VEC4_AT(push.sums, q * push.patchCount + index).rgb; }

vec2 compared(uint own, uint before, uint after, float share) {
    if (before == own) return vec2(0.0);
    vec3 d[kReplicates];
    for (uint q = 0u; q < kReplicates; ++q) d[q] = light(q, own) - mix(light(q, after), light(q, before), share);
    vec3 mean = 0.25 * (d[0] + d[1] + d[2] + d[3]);
    float noise = 0.0;
    for (uint q = 0u; q < kReplicates; ++q) noise += dot(d[q] - mean, d[q] - mean);
    return vec2(dot(mean, mean) - noise / float(kReplicates * (kReplicates - 1u)), 1.0);
}

void main() {
    uint chunk = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x, lane = gl_LocalInvocationID.x;
    if (chunk >= push.chunkCount) return;
    CoarseNeighbours n = Neighbours(push.neighbours).items[chunk * kChunk + lane];
    vec4 term = vec4(compared(n.own, n.left, n.right, n.shareX), compared(n.own, n.below, n.above, n.shareY));
    terms[lane] = term;
    barrier();
    if (lane != 0u) return;
    for (uint i = 1u; i < kChunk; ++i) term += terms[i];
    VEC4_AT(push.chunkSums, chunk) = term;
}
