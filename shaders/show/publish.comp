// Writes the light of patches to the texels that show them, as halves. There is one workgroup per chunk that
// changed. Ring 0 is its patches, ring r the texels of that ring beside charts that depend on it. Several
// chunks may fill the same texel with the same light.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/preamble.glsl"
#include "lib/seams.glsl"
layout(push_constant, scalar) uniform Push { PublishPush push; };
layout(constant_id = 0) const uint kDarkest = 0u; // 1: RTRad's choice among neighbours

const float kLargestHalf = 65504.0;
const float kShown = 1.0, kFilled = 0.5; // coverage

layout(local_size_x = 64) in;

void store(uint texel, vec4 value) {
    value.rgb = clamp(value.rgb, vec3(-kLargestHalf), vec3(kLargestHalf));
    uvec2 halves = uvec2(packHalf2x16(value.rg), packHalf2x16(value.ba));
    UVec2s texels = UVec2s(push.texels);
    if (UVEC2_AT(texels, texel) == halves) return;
    UVEC2_AT(texels, texel) = halves;
    uint region = texel / push.size / kRegion * ((push.size + kRegion - 1u) / kRegion) + texel % push.size / kRegion;
    WORD_AT(push.changed, region) = 1u;
}

void showPatches(uint chunk, uint lane) {
    uint index = chunk * kChunk + lane, texel = WORD_AT(push.patchTexels, index);
    vec3 value = VEC4_AT(push.values, index).rgb;
    if (texel != kNoTexel) store(texel, vec4(value * push.scale, kShown));
}

vec3 fromNeighbours(uvec2 fill) {
    ivec2 at = ivec2(int(fill.x % push.size), int(fill.x / push.size));
    vec3 sum = vec3(0.0), low = vec3(0.0);
    uint count = 0u;
    for (uint n = 0u; n < 8u; ++n) {
        if ((fill.y >> n & 1u) == 0u) continue;
        ivec2 from = at + seamOffset(n);
        uvec2 halves = UVEC2_AT(push.texels, uint(from.y) * push.size + uint(from.x));
        vec3 value = vec3(unpackHalf2x16(halves.x), unpackHalf2x16(halves.y).x);
        sum += value;
        if (count == 0u || length(value) < length(low)) low = value;
        ++count;
    }
    return kDarkest != 0u ? low : sum / float(count);
}

void main() {
    uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x, lane = gl_LocalInvocationID.x;
    if (group >= push.count) return;
    uint chunk = WORD_AT(push.chunks, push.first + group);
    if (push.ring == 0u) {
        showPatches(chunk, lane);
        return;
    }
    uint at = (push.ring - 1u) * push.chunkCount + chunk;
    uint end = WORD_AT(push.starts, at + 1u);
    for (uint i = WORD_AT(push.starts, at) + lane; i < end; i += kChunk) {
        uvec2 fill = UVEC2_AT(push.fills, i);
        store(fill.x, vec4(fromNeighbours(fill), kFilled));
    }
}
