// Makes the bits of a block from the other side, so that each ray serves both ends: word (column j) holds a
// bit per row i. A diagonal block, traced for i < j only, becomes the full symmetric block.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/preamble.glsl"
#include "lib/supers.glsl"
layout(push_constant, scalar) uniform Push { TransposePush push; };

layout(local_size_x = 64) in;

void main() {
    uint local = gl_WorkGroupID.x, lane = gl_LocalInvocationID.x;
    SuperBlock super = loadSuper(push.supers, gl_WorkGroupID.y);
    uint row = super.row * kSuper + local / kSuper;
    uint column = super.column * kSuper + local % kSuper;
    if (row > column || column >= push.chunkCount) return;

    Words bits = Words(super.bits);
    uint base = local * kBlockWords;
    uint word = base + push.reversed * kSuperWords + lane / 32u, shift = lane % 32u;
    uvec2 mask = uvec2(0u);
    for (uint i = 0u; i < 32u; ++i) {
        mask.x |= ((bits.items[word + i * 2u] >> shift) & 1u) << i;
        mask.y |= ((bits.items[word + 64u + i * 2u] >> shift) & 1u) << i;
    }
    if (row == column) mask |= uvec2(bits.items[base + lane * 2u], bits.items[base + lane * 2u + 1u]);
    Words transposed = Words(push.transposed);
    uint to = gl_WorkGroupID.y * kSuperWords + base + lane * 2u;
    transposed.items[to] = mask.x;
    transposed.items[to + 1u] = mask.y;
}
