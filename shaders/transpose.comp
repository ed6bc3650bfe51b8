// The bits of a block from the other side, so that each ray serves both ends: word (column j) holds a bit per row i.
// Of a diagonal block, traced for i < j only, this is the full symmetric block.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/preamble.glsl"
layout(push_constant, scalar) uniform Push { TransposePush push; };

layout(local_size_x = 64) in;

void main() {
    uint unit = push.firstSuper * kSuperBlocks + gl_WorkGroupID.y * kSuperBlocks + gl_WorkGroupID.x;
    uint lane = gl_LocalInvocationID.x;
    uvec2 pair = UVec2s(push.supers).items[unit / kSuperBlocks];
    uint row = pair.x * kSuper + (unit % kSuperBlocks) / kSuper;
    uint column = pair.y * kSuper + unit % kSuper;
    if (row > column || column >= push.chunkCount) return;

    Words bits = Words(push.bits), reversed = Words(push.reversed);
    uint base = (unit % push.bitsUnits) * kBlockWords;
    uint word = base + lane / 32u, shift = lane % 32u;
    uvec2 mask = uvec2(0u);
    for (uint i = 0u; i < 32u; ++i) {
        mask.x |= ((reversed.items[word + i * 2u] >> shift) & 1u) << i;
        mask.y |= ((reversed.items[word + 64u + i * 2u] >> shift) & 1u) << i;
    }
    if (row == column) mask |= uvec2(bits.items[base + lane * 2u], bits.items[base + lane * 2u + 1u]);
    Words transposed = Words(push.transposed);
    transposed.items[base + lane * 2u] = mask.x;
    transposed.items[base + lane * 2u + 1u] = mask.y;
}
