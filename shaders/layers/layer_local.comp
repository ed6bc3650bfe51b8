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
shared float squares[kChunk];
shared uint texels[kChunk];

// Returns the mean square of how far this texel and those next to it are off, as squaresOf() does on the CPU.
float squareAround(uint lane) {
    float sum = 0.0, count = 0.0;
    for (uint k = lane - min(lane, kTileReach); k < min(kChunk, lane + kTileReach + 1u); ++k) {
        if (!texelsTouch(texels[lane], texels[k], push.size)) continue;
        sum += squares[k];
        count += 1.0;
    }
    return sum / count;
}

void main() {
    uint chunk = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x, lane = gl_LocalInvocationID.x;
    if (chunk >= push.chunkCount) return;
    uint index = chunk * kChunk + lane;
    vec4 all = VEC4_AT(push.composite, index);
    uint flags = loadPatch(push.patches, index).flags;
    float own = (all.r + all.g + all.b) / 3.0;
    float off = min(push.deviation * all.w / max(own, push.least), kMostOff);
    squares[lane] = off * off;
    texels[lane] = patchIsShown(flags) ? patchTexel(flags) : kNoTexel;
    barrier();
    terms[lane] = vec4(0.0);
    if (patchIsShown(flags)) {
        uint bin = chunk % kBinCopies * kBinsOfCopy;
        if (push.deviation > 0.0) {
            float square = squareAround(lane);
            bin += kLightBins + binOf(sqrt(square), kLeastErrorOctave, kErrorBinsPerOctave, kErrorBins);
            terms[lane] = vec4(1.0, square, all.w * all.w, 0.0);
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
