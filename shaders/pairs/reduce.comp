// Adds the partial sums of some super-blocks to the patches they belong to, in the order of the list. There
// is one invocation per patch.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/preamble.glsl"
#include "lib/supers.glsl"
layout(push_constant, scalar) uniform Push { ReducePush push; };

layout(local_size_x = 64) in;

void main() {
    uint index = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u + gl_LocalInvocationID.x;
    if (index >= push.patchCount) return;
    uint super = index / kSuperPatches, local = index % kSuperPatches;
    Vec4s partial = Vec4s(push.partial), ligOut = Vec4s(push.ligOut);
    vec4 sum = ligOut.items[index];
    for (uint s = 0u; s < push.superCount; ++s) {
        uint row = SuperBlocks(push.supers).items[s].row, column = SuperBlocks(push.supers).items[s].column;
        if (row == super) sum += partial.items[s * 2u * kSuperPatches + local];
        else if (push.symmetric != 0u && column == super) sum += partial.items[(s * 2u + 1u) * kSuperPatches + local];
    }
    ligOut.items[index] = sum;
}
