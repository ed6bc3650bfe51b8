// Adds the light of the mesh lights' points that are seen to the replicates' sums. Where all polygons are
// sampled, replicates tell each other the share that is seen (lib/light/seen_light.glsl); a pick belongs to one
// replicate, and its light is F_polygon L sum(V f) / sum(f), f being each point's own form factor. There is one
// workgroup per chunk and one invocation per patch.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/preamble.glsl"
#include "lib/sampling.glsl"
layout(push_constant, scalar) uniform Push { DirectPush push; };
#include "lib/light/penumbra_sample_passes.glsl"
#include "lib/light/seen_light.glsl"

layout(local_size_x = 64) in;

const uint kTargetsPerWord = 32u; // lib/rays/segments.glsl

uint chunk, lane;

bool seen(uint target) {
    uint words = (push.pickCount * push.pointCount + kTargetsPerWord - 1u) / kTargetsPerWord;
    uint word = WORD_AT(push.bits, (chunk * words + target / kTargetsPerWord) * kChunk + lane);
    return ((word >> (target % kTargetsPerWord)) & 1u) != 0u;
}

void main() {
    chunk = gl_WorkGroupID.x;
    lane = gl_LocalInvocationID.x;
    uint index = (push.firstChunk + chunk) * kChunk + lane;
    uint taken = takenSamplePasses(index);
    if (taken == 0u) return;
    bool all = push.all != 0u;
    uint reachedEmitters = 0u, hiddenEmitters = 0u;
    vec3 value[kReplicates];
    for (uint q = 0u; q < kReplicates; ++q) value[q] = vec3(0.0);
    for (uint pick = 0u; pick < push.pickCount; ++pick) {
        vec4 picked = VEC4_AT(push.picks, (chunk * push.pickCount + pick) * kChunk + lane);
        vec3 light = picked.rgb;
        uint first = pick * push.pointCount;
        float sum = 0.0, visible = 0.0;
        float part[kReplicates], partVisible[kReplicates]; // of each replicate's points
        for (uint q = 0u; q < kReplicates; ++q) part[q] = partVisible[q] = 0.0;
        for (uint s = 0u; s < push.pointCount; s += kReplicates) {
            for (uint q = 0u; q < kReplicates; ++q) {
                float w = VEC4_AT(push.targets, (chunk * push.pickCount * push.pointCount + first + s + q) * kChunk + lane).w;
                float f = abs(w), v = w > 0.0 && seen(first + s + q) ? f : 0.0;
                part[q] += f;
                partVisible[q] += v;
                sum += f;
                visible += v;
            }
        }
        float share = sum > 0.0 ? visible / sum : 0.0;
        uint bit = light != vec3(0.0) ? 1u << (pick % 32u) : 0u;
        if (visible > 0.0) reachedEmitters |= bit;
        if (visible < sum) hiddenEmitters |= bit;
        if (!all && bit != 0u) reachedEmitters = hiddenEmitters = ~0u; // which are picked is chance
        for (uint q = 0u; q < kReplicates; ++q) {
            float count = float(push.pointCount / push.together * taken / kReplicates); // of each replicate's points
            if (all && picked.w > 0.0)
                value[q] += light * (float(taken) * seenLight(picked.w, count, part[q], partVisible[q], sum, visible) / picked.w);
            else if (pick % kReplicates == q) value[q] += light * (share * float(kReplicates) / float(push.pickCount));
        }
    }
    noteLights(index, reachedEmitters, hiddenEmitters);
    vec3 total = vec3(0.0);
    Vec4s sums = Vec4s(push.sums);
    for (uint q = 0u; q < kReplicates; ++q) {
        vec3 s = VEC4_AT(sums, q * push.patchCount + index).rgb + value[q];
        VEC4_AT(sums, q * push.patchCount + index) = vec4(s, 0.0);
        total += s;
    }
    VEC4_AT(push.direct, index) = vec4(max(total * push.scale, 0.0), 1.0);
}
