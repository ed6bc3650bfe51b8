// Adds the light of a group of analytic lights to the replicates' sums. Where the unshadowed light of a whole
// one is known, its samples tell the share that is seen; else their mean is the light. There is one workgroup
// per chunk and one invocation per patch.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/light/lamp_group.glsl"
#include "lib/light/seen_light.glsl"

layout(local_size_x = 64) in;

const uint kTargetsPerWord = 32u; // lib/rays/segments.glsl

uint chunk, lane;

// Returns what was sampled; the sky's light, of three colours, is made again.
LampRay sampled(Lamp l, Receiver r, uint s) {
    if (isLamp(l, kLampSky)) return lampRay(l, r, s);
    float light = VEC4_AT(push.targets, (chunk * targetCount() + l.firstTarget + s) * kChunk + lane).w;
    return LampRay(vec3(0.0), vec3(abs(light)), light > 0.0);
}

// Returns the light that a patch is taken to have of one that all rays of its chunk have reached. Where only samples
// tell, none of the patch's own have said anything, and it is taken to have none.
vec3 notedLight(Lamp l, Receiver r) { return max(wholeLight(l, r), vec3(0.0)); }

bool seen(uint target) {
    uint words = (targetCount() + kTargetsPerWord - 1u) / kTargetsPerWord;
    uint word = WORD_AT(push.bits, (chunk * words + target / kTargetsPerWord) * kChunk + lane);
    return ((word >> (target % kTargetsPerWord)) & 1u) != 0u;
}

void main() {
    chunk = gl_WorkGroupID.x;
    lane = gl_LocalInvocationID.x;
    uint index = listedChunk(chunk) * kChunk + lane;
    uint taken = takenSamplePasses(index);
    if (taken == 0u) return;
    Receiver r = receiver(index);
    vec3 value[kReplicates];
    for (uint q = 0u; q < kReplicates; ++q) value[q] = vec3(0.0);
    uint reachedLamps = 0u, hiddenLamps = 0u;
    for (uint k = 0u; k < lampCount(); ++k) {
        Lamp l = loadLamp(k);
        uint bit = lampBit(k);
        LightNote note = lampNote(l, r, index, k);
        if (!note.asked) {
            if (note.seen > 0.0)
                for (uint q = 0u; q < kReplicates; ++q) value[q] += l.color * notedLight(l, r);
            continue;
        }
        vec3 part[kReplicates], partSeen[kReplicates]; // of each replicate's samples
        for (uint q = 0u; q < kReplicates; ++q) part[q] = partSeen[q] = vec3(0.0);
        float all = 0.0, visible = 0.0; // of any one component: but for the sky they are alike
        uint samples = takenSamples(l, taken);
        for (uint s = 0u; s < samples; ++s) {
            LampRay ray = sampled(l, r, s);
            bool reached = ray.traced && seen(l.firstTarget + s);
            part[s % kReplicates] += ray.light;
            all += ray.light.r;
            if (reached) reachedLamps |= bit;
            else if (ray.light != vec3(0.0)) hiddenLamps |= bit;
            if (!reached) continue;
            partSeen[s % kReplicates] += ray.light;
            visible += ray.light.r;
        }
        float whole = lampWhole(l, r.spread, r.p.shading);
        // A light is asked again where no share is known of what is reached, and where a few samples may have missed all.
        bool uneven = lampUnevenness(l, r.spread.middle, r.spread.size) == kLightUneven;
        if (l.samples > 1u && whole < 0.0 && (all > 0.0 || uneven)) {
            if (!takesNotes()) reachedLamps = hiddenLamps = ~0u;
            else if (uneven) reachedLamps |= bit, hiddenLamps |= bit;
            else if (visible > 0.0 && wholeLight(l, r).r < 0.0) hiddenLamps |= bit;
        }
        for (uint q = 0u; q < kReplicates; ++q) {
            vec3 unit = partSeen[q] * (float(kReplicates) / float(samples));
            if (l.samples == 1u) {
                unit = partSeen[0];
            } else if (whole >= 0.0) {
                float count = float(samples / kReplicates);
                unit = vec3(seenLight(whole, count, part[q].r, partSeen[q].r, all, visible));
            }
            if (note.known) {
                vec3 noted = note.seen > 0.0 ? notedLight(l, r) : vec3(0.0);
                unit = noted + float(kNoteSamplePasses) * (unit - noted);
            }
            value[q] += l.color * (float(taken) * unit);
        }
    }
    if ((r.p.flags & kPatchSends) == 0u) return;
    noteLights(index, reachedLamps, hiddenLamps);
    vec3 total = vec3(0.0);
    Vec4s sums = Vec4s(push.sums);
    for (uint q = 0u; q < kReplicates; ++q) {
        vec3 s = VEC4_AT(sums, q * push.patchCount + index).rgb + value[q];
        VEC4_AT(sums, q * push.patchCount + index) = vec4(s, 0.0);
        total += s;
    }
    VEC4_AT(push.direct, index) = vec4(max(total * push.scale, 0.0), 1.0);
}
