// Makes segments from patches to places in their texels. There is one workgroup per chunk and one invocation per
// patch.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/preamble.glsl"
#include "lib/sampling.glsl"
#include "shared_objects.h"
layout(push_constant, scalar) uniform Push { PlacesPush push; };
#include "lib/rays/start_point.glsl"

layout(local_size_x = 64) in;

void main() {
    uint chunk = gl_WorkGroupID.x, lane = gl_LocalInvocationID.x, index = (push.firstChunk + chunk) * kChunk + lane;
    bool asks = (WORD_AT(push.asks, chunk * 2u + lane / 32u) >> lane % 32u & 1u) != 0u;
    Patch p = loadPatch(push.patches, index);
    PatchCover cover = loadCover(push.covers, index);
    uint here = 0u;
    for (uint k = 0u; k < push.places; ++k) {
        vec4 target = vec4(0.0);
        if (asks) target = placeTarget(p, cover, push.places == kRimPlaces ? rimPlace(k) : cellPlace(k));
        if (asks && target.w == 0.0) here |= 1u << k;
        VEC4_AT(push.targets, (chunk * push.places + k) * kChunk + lane) = target;
    }
    WORD_AT(push.here, chunk * kChunk + lane) = here;
}
