// Counts the composite's texels by their light, or by how far they are off, and sums up over each chunk what goes with
// that. There is one workgroup per chunk.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/preamble.glsl"
#include "lib/local_error.glsl"
layout(push_constant, scalar) uniform Push { LayerLocalPush push; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Bins { uint items[]; };

layout(local_size_x = 64) in;

// This keeps squares finite where light is next to none.
const float kMostOff = 1e15;

shared vec4 terms[kChunk];

void main() {
    uint chunk = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x, lane = gl_LocalInvocationID.x;
    if (chunk >= push.chunkCount) return;
    uint index = chunk * kChunk + lane;
    terms[lane] = vec4(0.0);
    if (patchIsShown(loadPatch(push.patches, index).flags)) {
        vec4 all = VEC4_AT(push.composite, index);
        float own = (all.r + all.g + all.b) / 3.0;
        uint bin = chunk % kBinCopies * kBinsOfCopy;
        if (push.deviation > 0.0) {
            own = max(own, push.least);
            float off = push.deviation * all.w / own;
            bin += kLightBins + binOf(off, kLeastErrorOctave, kErrorBinsPerOctave, kErrorBins);
            off = min(off, kMostOff);
            terms[lane] = vec4(1.0, off * off, all.w * all.w, 0.0);
        } else {
            bin += binOf(own, kLeastLightOctave, kLightBinsPerOctave, kLightBins);
            terms[lane] = vec4(1.0, own, all.w * all.w, 0.0);
        }
        atomicAdd(Bins(push.bins).items[bin], 1u);
    }
    barrier();
    if (lane != 0u) return;
    vec4 sum = terms[0];
    for (uint i = 1u; i < kChunk; ++i) sum += terms[i];
    VEC4_AT(push.chunkSums, chunk) = sum;
}
