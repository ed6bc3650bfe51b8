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
    uint chunk = WORD_AT(push.chunks, push.first + index);
    vec4 sum = vec4(0.0);
    for (uint i = chunk * kChunk; i < (chunk + 1u) * kChunk; ++i) {
        if (WORD_AT(push.patchTexels, i) != kNoTexel) sum += vec4(VEC4_AT(push.values, i).rgb, 1.0);
    }
    VEC4_AT(push.sums, chunk) = sum;
}
