// Makes the result: direct light plus indirect light, smoothed along columns (rows are done), with each
// patch's standard error from the spread of the replicates in w. Sums for the error of the whole go to one
// ResolveSums per chunk. There is one workgroup per chunk.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/preamble.glsl"
layout(push_constant, scalar) uniform Push { SmoothPush push; };
#include "lib/smoothing.glsl"
#include "lib/replicates.glsl"
#include "lib/local_error.glsl"
layout(buffer_reference, scalar, buffer_reference_align = 4) writeonly buffer SumsList { ResolveSums items[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer LocalErrors {
    uint bins[kBinCopies * kBinsOfCopy]; // of light, then of errors
    LocalSums items[];
};

layout(local_size_x = 64) in;

shared ResolveSums terms[kChunk];
shared LocalSums localTerms[kChunk];

float channelMean(vec3 v) { return (v.r + v.g + v.b) / 3.0; }

// Returns the three ways to take the mean of two replicates from that of the two others, halved. Each has the
// distribution that the error of the mean of all four has.
vec3 contrasts(vec3 v[kReplicates]) {
    float a = channelMean(v[0]), b = channelMean(v[1]), c = channelMean(v[2]), d = channelMean(v[3]);
    return 0.25 * vec3(a + b - c - d, a - b + c - d, a - b - c + d);
}

// Notes the light of a texel that is shown, and how far it is off.
LocalSums localTerm(uint chunk, vec3 light, vec3 direct[kReplicates], vec3 smoothed[kReplicates], vec3 moved[kReplicates]) {
    LocalErrors local = LocalErrors(push.local);
    float own = channelMean(light), relativeTo = max(max(own, push.floor), 1e-30);
    uint lights = chunk % kBinCopies * kBinsOfCopy, errors = lights + kLightBins;
    atomicAdd(local.bins[lights + binOf(own, kLeastLightOctave, kLightBinsPerOctave, kLightBins)], 1u);
    vec3 directOff = contrasts(direct), off = contrasts(smoothed), moves = contrasts(moved);
    for (uint k = 0u; k < 3u; ++k) {
        float error = abs(directOff[k] + off[k]) / relativeTo;
        atomicAdd(local.bins[errors + binOf(error, kLeastErrorOctave, kErrorBinsPerOctave, kErrorBins)], 1u);
    }
    float move = 0.25 * channelMean(moved[0] + moved[1] + moved[2] + moved[3]);
    // Replicates know nothing of each other, so the mean of this product is what they have in common.
    float fourth = 1.0;
    for (uint q = 0u; q < kReplicates; ++q) fourth *= channelMean(moved[q]) / relativeTo;
    return LocalSums(dot(directOff, directOff) / (3.0 * relativeTo * relativeTo),
                     dot(off, off) / (3.0 * relativeTo * relativeTo),
                     (move * move - dot(moves, moves) / 3.0) / (relativeTo * relativeTo),
                     fourth);
}

void main() {
    uint chunk = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x, lane = gl_LocalInvocationID.x;
    if (chunk >= push.chunkCount) return;
    chunk += push.firstChunk;
    uint index = chunk * kChunk + lane;
    vec3 direct[kReplicates], raw[kReplicates], smoothed[kReplicates], moved[kReplicates];
    vec2 scales = vec2IfAny(push.scales, chunk, push.patches, vec2(push.scale, push.directScale));
    float rowScale = push.scales != 0ul ? 1.0 : push.scale; // else rows are of means
    for (uint q = 0u; q < kReplicates; ++q) {
        direct[q] = scales.y * vec4IfAny(push.directSums, q * push.patchCount + index, push.patches).rgb;
        raw[q] = scales.x * VEC4_AT(push.sums, q * push.patchCount + index).rgb;
        smoothed[q] = vec3(0.0);
    }
    if (push.reach > 0u) {
        Taps taps = smoothingTaps(index, ivec2(0, 1));
        for (uint t = 0u; t < 2u * push.reach + 1u; ++t) {
            if (taps.weight[t] == 0.0) continue;
            for (uint q = 0u; q < kReplicates; ++q) {
                vec3 row = VEC4_AT(push.rows, q * push.patchCount + taps.index[t]).rgb;
                smoothed[q] += rowScale * taps.weight[t] * row;
            }
        }
    } else {
        smoothed = raw;
    }
    for (uint q = 0u; q < kReplicates; ++q) moved[q] = smoothed[q] - raw[q];
    vec3 mean = 0.25 * (smoothed[0] + smoothed[1] + smoothed[2] + smoothed[3]);
    vec3 move = 0.25 * (moved[0] + moved[1] + moved[2] + moved[3]);
    // Sums of weights of both signs may end a little below nothing.
    vec3 light = max(0.25 * (direct[0] + direct[1] + direct[2] + direct[3]) + mean, 0.0);

    ResolveSums term = ResolveSums(0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    uint flags = loadPatch(push.patches, index).flags;
    float directVariance = spread(direct), indirectVariance = spread(smoothed);
    if (patchIsShown(flags)) {
        term.light = light.r + light.g + light.b;
        term.direct = directVariance;
        term.indirect = indirectVariance;
        term.raw = spread(raw);
        term.bias = dot(move, move) - spread(moved);
        term.count = 1.0;
    }
    if (push.local != 0ul)
        localTerms[lane] = patchIsShown(flags) ? localTerm(chunk, light, direct, smoothed, moved) : LocalSums(0.0, 0.0, 0.0, 0.0);
    VEC4_AT(push.result, index) = vec4(light, sqrt((directVariance + indirectVariance) / 3.0));
    terms[lane] = term;
    barrier();
    if (lane != 0u) return;
    for (uint i = 1u; i < kChunk; ++i) {
        term.light += terms[i].light;
        term.direct += terms[i].direct;
        term.indirect += terms[i].indirect;
        term.raw += terms[i].raw;
        term.bias += terms[i].bias;
        term.count += terms[i].count;
    }
    SumsList(push.chunkSums).items[chunk] = term;
    if (push.local == 0ul) return;
    LocalSums total = localTerms[0];
    for (uint i = 1u; i < kChunk; ++i) {
        total.direct += localTerms[i].direct;
        total.indirect += localTerms[i].indirect;
        total.bias += localTerms[i].bias;
        total.fourth += localTerms[i].fourth;
    }
    LocalErrors(push.local).items[chunk] = total;
}
