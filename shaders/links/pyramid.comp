// Makes what the nodes of one level send: the mean over their children's areas. There is one invocation per
// node.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/preamble.glsl"
layout(push_constant, scalar) uniform Push { PyramidPush push; };

layout(local_size_x = 64) in;

void main() {
    uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    uint local = group * 64u + gl_LocalInvocationID.x;
    if (local >= push.nodeCount) return;
    uint node = push.firstNode + local;
    Vec4s radiance = Vec4s(push.radiance);
    uvec4 children = PyramidNodes(push.nodes).items[node].children;
    vec4 shares = PyramidNodes(push.nodes).items[node].shares;
    vec4 mean = vec4(0.0);
    for (uint c = 0u; c < 4u; ++c) mean += shares[c] * VEC4_AT(radiance, children[c]);
    VEC4_AT(radiance, push.patchCount + node) = mean;
}
