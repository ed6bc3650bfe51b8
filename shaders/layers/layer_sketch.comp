// Makes the sketch of the error of a layer's indirect light: how far each replicate is from their mean, summed
// over patches, each with a random sign (lib/sketch.glsl). There is one workgroup per kSketchStride-th chunk.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/preamble.glsl"
layout(push_constant, scalar) uniform Push { SketchPush push; };
#include "lib/sampling.glsl"
#include "lib/sketch.glsl"
layout(buffer_reference, scalar, buffer_reference_align = 4) writeonly buffer SketchList { vec3 items[]; };

layout(local_size_x = 64) in;

shared vec3 terms[kReplicates][kChunk];

void main() {
    uint first = gl_WorkGroupID.x, lane = gl_LocalInvocationID.x;
    uint patchCount = push.chunkCount * kChunk;
    vec3 sum[kReplicates];
    for (uint q = 0u; q < kReplicates; ++q) sum[q] = vec3(0.0);
    for (uint chunk = first; chunk < push.chunkCount; chunk += kSketchStride) {
        uint index = chunk * kChunk + lane;
        if (!patchIsShown(loadPatch(push.patches, index).flags)) continue;
        vec3 value[kReplicates], mean = vec3(0.0);
        for (uint q = 0u; q < kReplicates; ++q) {
            value[q] = VEC4_AT(push.sums, q * patchCount + index).rgb;
            mean += value[q];
        }
        mean *= 1.0 / float(kReplicates);
        float sign = sketchSign(index);
        for (uint q = 0u; q < kReplicates; ++q) sum[q] += sign * (value[q] - mean);
    }
    for (uint q = 0u; q < kReplicates; ++q) terms[q][lane] = sum[q];
    barrier();
    if (lane >= kSketchParts * kReplicates) return;
    const uint kLanes = kChunk / kSketchParts;
    uint part = lane / kReplicates, q = lane % kReplicates;
    vec3 total = vec3(0.0);
    for (uint i = part * kLanes; i < (part + 1u) * kLanes; ++i) total += terms[q][i];
    SketchList(push.sketch).items[first * kSketchParts * kReplicates + lane] = total;
}
