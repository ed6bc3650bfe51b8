// Adds the light of the mesh lights' points that are seen to the replicates' sums. Where all polygons are
// sampled, replicates tell each other the share that is seen (lib/light/seen_light.glsl), and so they do where these are
// picked and what all of them bring without shadows is known. Else a pick belongs to one replicate, and its light is
// F_polygon L sum(V f) / sum(f), f being each point's own form factor. There is one workgroup per chunk and one
// invocation per patch.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/preamble.glsl"
#include "lib/sampling.glsl"
layout(push_constant, scalar) uniform Push { DirectPush push; };
#define LISTED_INSTEAD push.picks
#include "lib/listed_chunk.glsl"
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

uint reachedEmitters = 0u, hiddenEmitters = 0u;
vec3 value[kReplicates]; // of the sample passes that the patch takes

// Returns the form factor that a point stands for, negative where it is not seen.
float seenFactor(uint target) {
    float w = VEC4_AT(push.targets, (chunk * push.pickCount * push.pointCount + target) * kChunk + lane).w;
    return w > 0.0 && seen(target) ? w : -abs(w);
}

void gatherPolygons(uint taken) {
    bool all = push.all != 0u;
    uint ofSamplePass = all ? push.pickCount : push.pickCount / push.together;
    uint picks = all ? push.pickCount : ofSamplePass * taken;
    for (uint pick = 0u; pick < picks; ++pick) {
        vec4 picked = VEC4_AT(push.picks, (chunk * push.pickCount + pick) * kChunk + lane);
        vec3 light = picked.rgb;
        uint first = pick * push.pointCount;
        float sum = 0.0, visible = 0.0;
        float part[kReplicates], partVisible[kReplicates]; // of each replicate's points
        for (uint q = 0u; q < kReplicates; ++q) part[q] = partVisible[q] = 0.0;
        for (uint s = 0u; s < push.pointCount; s += kReplicates) {
            for (uint q = 0u; q < kReplicates; ++q) {
                float w = seenFactor(first + s + q), f = abs(w), v = max(w, 0.0);
                part[q] += f;
                partVisible[q] += v;
                sum += f;
                visible += v;
            }
        }
        float share = sum > 0.0 ? visible / sum : 0.0;
        // Each replicate's points start elsewhere, and know what is near from there.
        vec4 wholes = vec4(0.0);
        if (all && picked.w < 0.0) wholes = VEC4_AT(push.picks, ((push.firstNear + chunk) * push.pickCount + pick) * kChunk + lane);
        uint bit = light != vec3(0.0) ? 1u << (pick % 32u) : 0u;
        if (visible > 0.0) reachedEmitters |= bit;
        if (visible < sum) hiddenEmitters |= bit;
        if (!all && bit != 0u) reachedEmitters = hiddenEmitters = ~0u; // which are picked is chance
        for (uint q = 0u; q < kReplicates; ++q) {
            float count = float(push.pointCount / push.together * taken / kReplicates); // of each replicate's points
            if (all && picked.w != 0.0) {
                float whole = picked.w > 0.0 ? picked.w : wholes[q];
                value[q] += light * (float(taken) * seenLight(whole, count, part[q], partVisible[q], sum, visible) / abs(picked.w));
            }
            else if (pick % kReplicates == q) value[q] += light * (share * float(kReplicates) / float(ofSamplePass));
        }
    }
}

// Does so for picks of one point each.
void gatherPicks(uint taken, vec4 all) {
    bool near = all.w > 0.0;
    uint count = push.pickCount / push.together * taken;
    vec3 part[kReplicates], partVisible[kReplicates], sum = vec3(0.0), visible = vec3(0.0);
    vec3 whole[kReplicates];
    float each = float(count / kReplicates);
    for (uint q = 0u; q < kReplicates; ++q) {
        part[q] = partVisible[q] = vec3(0.0);
        whole[q] = all.rgb;
    }
    for (uint pick = 0u; pick < count; pick += kReplicates) {
        for (uint q = 0u; q < kReplicates; ++q) {
            if (near) whole[q] += VEC4_AT(push.picks, ((push.firstNear + chunk) * push.pickCount + pick + q) * kChunk + lane).rgb / each;
            float w = seenFactor(pick + q);
            if (w == 0.0) continue;
            vec3 light = abs(w) * VEC4_AT(push.picks, (chunk * push.pickCount + pick + q) * kChunk + lane).rgb;
            part[q] += light;
            sum += light;
            if (w > 0.0) {
                partVisible[q] += light;
                visible += light;
                reachedEmitters = 1u;
            } else hiddenEmitters = 1u;
        }
    }
    if (near) reachedEmitters = hiddenEmitters = 1u; // it is seen as unevenly over a texel as in a penumbra
    for (uint q = 0u; q < kReplicates; ++q)
        value[q] = float(taken) * seenPicks(whole[q], each, part[q], partVisible[q], sum, visible);
}

void main() {
    chunk = gl_WorkGroupID.x;
    lane = gl_LocalInvocationID.x;
    uint index = listedChunk(chunk) * kChunk + lane;
    uint taken = takenSamplePasses(index);
    if (taken == 0u) return;
    for (uint q = 0u; q < kReplicates; ++q) value[q] = vec3(0.0);
    if (push.wholes != 0ul) gatherPicks(taken, VEC4_AT(push.wholes, index));
    else gatherPolygons(taken);
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
