// Makes the harmonic mean of the distances along a sample pass's links: how far away what lights a patch is,
// and so over what length its indirect light may change [Ward et al. 1988]. A surface that lies along a row of
// texels looks the same from the next texel of it, however near it is: beside a wall light changes fast across
// the edge and slowly along it. So there are two of them, and each link counts by how much its end's surface
// turns towards the row or the column. There is one workgroup per chunk and one invocation per patch.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/preamble.glsl"
layout(push_constant, scalar) uniform Push { LinkDistancePush push; };

layout(local_size_x = 64) in;

// A surface along the row may end, and its light changes: it counts so much all the same.
const float kLeastTurn = 0.45;

// Returns the position of the patch at a texel of the same chart, `otherwise` where there is none.
vec3 positionAt(ivec2 texel, uint chart, vec3 otherwise) {
    if (any(lessThan(texel, ivec2(0))) || any(greaterThanEqual(texel, ivec2(push.size)))) return otherwise;
    uint index = WORD_AT(push.texelToPatch, uint(texel.y) * push.size + uint(texel.x));
    if (index == kNoPatch || WORD_AT(push.patchChart, index) != chart) return otherwise;
    return loadPatch(push.patches, index).position;
}

// Returns the direction in the world in which a row or column of texels goes on; zero where that is unknown.
vec3 wayOf(Patch own, uint chart, ivec2 axis) {
    if (push.size == 0u) return vec3(0.0);
    uint index = patchTexel(own.flags);
    ivec2 texel = ivec2(index % push.size, index / push.size);
    vec3 d = positionAt(texel + axis, chart, own.position) -
             positionAt(texel - axis, chart, own.position);
    return d * inversesqrt(max(dot(d, d), 1e-30));
}

float turnOf(vec3 normal, vec3 way) {
    return way == vec3(0.0) ? 1.0 : max(abs(dot(normal, way)), kLeastTurn);
}

void main() {
    uint chunk = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    if (chunk >= push.chunkCount) return;
    uint lane = gl_LocalInvocationID.x, index = (push.firstChunk + chunk) * kChunk + lane;
    Patch own = loadPatch(push.receivers, index);
    uint chart = push.size > 0u ? WORD_AT(push.patchChart, index) : 0u;
    vec3 row = wayOf(own, chart, ivec2(1, 0)), column = wayOf(own, chart, ivec2(0, 1));
    vec2 sum = vec2(0.0);
    for (uint k = 0u; k < push.sampleCount; ++k) {
        uint link = WORD_AT(push.links, (chunk * push.sampleCount + k) * kChunk + lane);
        if (link >= kLinkFirstSpecial) continue; // nothing, or what sends no light
        vec3 end;
        vec2 turn = vec2(1.0); // of a node, whose patches may face many ways
        if (link < push.patchCount) {
            Patch other = loadPatch(push.patches, link);
            end = other.position;
            turn = vec2(turnOf(other.normal, row), turnOf(other.normal, column));
        } else {
            end = PyramidNodes(push.nodes).items[link - push.patchCount].position;
        }
        vec3 d = end - own.position;
        sum += turn * inversesqrt(max(dot(d, d), 1e-30));
    }
    for (uint axis = 0u; axis < 2u; ++axis)
        FLOAT_AT(push.distances, 2u * index + axis) =
            sum[axis] > 0.0 ? float(push.sampleCount) / sum[axis] : 1e30;
}
