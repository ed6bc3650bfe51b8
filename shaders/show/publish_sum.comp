// Sums what is shown of some chunks, for the mean. There is one invocation per chunk, which costs a software
// device far less than adding up across invocations.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/preamble.glsl"
layout(push_constant, scalar) uniform Push { PublishPush push; };

layout(local_size_x = 64) in;

void main() {
    uint index = gl_WorkGroupID.x * 64u + gl_LocalInvocationID.x;
    if (index >= push.count) return;
    uint chunk = Words(push.chunks).items[push.first + index];
    vec4 sum = vec4(0.0);
    for (uint i = chunk * kChunk; i < (chunk + 1u) * kChunk; ++i) {
        if (Words(push.patchTexels).items[i] != kNoTexel) sum += vec4(Vec4s(push.values).items[i].rgb, 1.0);
    }
    Vec4s(push.sums).items[chunk] = sum;
}
