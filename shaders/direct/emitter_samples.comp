// Makes points on mesh lights for the patches of some chunks: which polygon, where on it, and what it would
// send unshadowed. There is one workgroup per chunk (x) and pick (y), and one invocation per patch. One more row of
// workgroups finds what all polygons send unshadowed, where that is not known yet.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/preamble.glsl"
#include "lib/sampling.glsl"
#include "lib/form_factor.glsl"
#include "lib/light/polygon_sample.glsl"
layout(push_constant, scalar) uniform Push { EmitterSamplesPush push; };
#define LISTED_INSTEAD push.patches
#include "lib/listed_chunk.glsl"
#include "lib/rays/starts.glsl"
#include "lib/light/texel_mean.glsl"
#include "lib/light/emitters.glsl"
EmitterNode emitterNode(uint index) { return loadEmitterNode(push.nodes, index); }
EmitterPolygon emitterPolygon(uint index) { return loadEmitterPolygon(push.polygons, index); }
EmitterEdge emitterEdge(uint index) { return loadEmitterEdge(push.edges, index); }
#include "lib/light/pick_emitter.glsl"
#include "lib/light/whole_emitter.glsl"
#include "lib/light/penumbra_sample_passes.glsl"

layout(local_size_x = 64) in;

// The salt keeps the numbers of picks apart from those of directions, which start from the same seeds.
const uint kPickSalt = 0x5bd1e995u;

uint unevennessOfAll(TexelSpread t) { return unevenness(t.size, nodeDistance(t.middle, emitterNode(0u))); }

// Tells so a little farther than the light is uneven: others, who decide that, may round otherwise.
bool mayBeUneven(TexelSpread t) { return nodeDistance(t.middle, emitterNode(0u)) < 1.01 * kNearSizes * t.size; }

vec3 allLight(vec3 from, vec3 n) { return wholeEmitterLight(from, n, push.polygonCount, push.edgeCount); }

// Finds the mean of the whole light; where it is uneven, each point knows that of where it starts.
void findWhole(Patch p, uint index) {
    bool sends = (p.flags & kPatchSends) != 0u;
    TexelSpread t = texelSpread(p, coverOf(index));
    uint uneven = unevennessOfAll(t);
    vec3 light = vec3(0.0);
    if (sends && uneven == kLightEven) light = allLight(t.middle, p.shading);
    if (sends && uneven == kLightCurved)
        for (uint i = 0u; i < kSpreadPoints; ++i) light += allLight(spreadPoint(t, i), p.shading) / float(kSpreadPoints);
    VEC4_AT(push.wholes, index) = vec4(light, sends && uneven == kLightUneven ? 1.0 : 0.0);
}

void main() {
    uint chunk = gl_WorkGroupID.x, pick = gl_WorkGroupID.y, lane = gl_LocalInvocationID.x;
    uint index = listedChunk(chunk) * kChunk + lane;
    Patch p = loadPatch(push.patches, index);
    if (pick == push.pickCount) {
        findWhole(p, index);
        return;
    }
    uint base = (chunk * push.pickCount + pick) * push.pointCount;
    // Together, sample passes have more points on each polygon, or more picks.
    bool onePoint = push.wholes != 0ul, all = push.all != 0u;
    uint taken = takenSamplePasses(index), points = all ? push.pointCount / push.together * taken : push.pointCount;
    if (taken == 0u || (!all && pick >= push.pickCount / push.together * taken)) { // it is not asked for
        for (uint s = 0u; s < push.pointCount; ++s) VEC4_AT(push.targets, (base + s) * kChunk + lane) = vec4(0.0);
        return;
    }
    uint key = seedKey(p);
    PatchCover cover = coverOf(index);
    TexelSpread spread = texelSpread(p, cover);
    Patch start = p; // a pick of one point is drawn for where that starts
    if (onePoint) start = startingPatch(p, cover, startNumber(pick, push.samplePass, push.pickCount, 1u));
    uint emitter = pick, sequence = 0u; // of the pick's points, where it has one of its own
    float probability = 1.0;
    if (!all) {
        uint number = push.samplePass * push.pickCount + pick;
        uint seed = hash32(replicateSeed(key, number) ^ kPickSalt);
        float u = sobolPoint(replicateIndex(number), seed).x, nearby = max(spread.size, sqrt(p.area));
        if (hasNearEmitter(spread.middle, nearby)) {
            PickView view = pointView(start.position, start.shading);
            view.near = nearby;
            view.count = onePoint ? 0u : min(push.pointCount, kPickStarts);
            for (uint s = 0u; s < view.count; ++s)
                view.starts[s] = startingPatch(p, cover, startNumber(pick * push.pointCount + s, push.samplePass,
                                                                     push.pickCount * push.pointCount, push.pointCount)).position;
            emitter = pickNearEmitter(view, u, probability);
        } else {
            emitter = pickEmitter(start.position, start.shading, u, probability);
        }
        sequence = replicateIndex(number) * push.pointCount;
    }
    vec3 light = vec3(0.0);
    float whole = 0.0; // form factor, without shadows
    bool near = false; // the form factor is the mean over the points that samples start from
    bool shines = false;
    EmitterPolygon e;
    if (emitter != kNoEmitter && (p.flags & kPatchSends) != 0u) {
        e = emitterPolygon(emitter);
        uint uneven = onePoint ? kLightEven : unevenness(spread.size, polygonDistance(spread.middle, e));
        if (onePoint) whole = 1.0; // the point's own tells
        else whole = uneven == kLightEven ? emitterFormFactor(spread.middle, p.shading, e) : spreadFormFactor(spread, p.shading, e);
        light = e.radiance * (whole / probability);
        near = uneven == kLightUneven && (whole > 0.0 || mayShineOn(spread, p.shading, e));
        shines = (whole > 0.0 || near) && e.radiance != vec3(0.0);
    }
    near = near && shines;
    // A near light is seen as unevenly over a texel as in a penumbra.
    if (near) noteLights(index, 1u << (pick % 32u), 1u << (pick % 32u));
    vec4 factors = vec4(0.0); // of each replicate's starts
    if (onePoint && mayBeUneven(spread)) {
        vec3 ofAll = allLight(start.position, start.shading);
        VEC4_AT(push.picks, ((push.firstNear + chunk) * push.pickCount + pick) * kChunk + lane) = vec4(ofAll, 0.0);
    }
    vec3 off = shines ? e.offset * emitterNormal(e) : vec3(0.0);
    for (uint s = 0u; s < push.pointCount; ++s) {
        vec4 point = vec4(0.0);
        if (shines && s < points) {
            // If all polygons are sampled, a patch's points take turns among the replicates; if they are
            // picked, a pick's points belong to one.
            uint number = all ? push.samplePass * push.pointCount + s : pick;
            uint turn = all ? replicateIndex(number) : sequence + s;
            uint seed = emitterPointSeed(key, number, all ? emitter : 0u);
            uint target = pick * push.pointCount + s;
            uint startOf = startNumber(target, push.samplePass, all ? push.pointCount : push.pickCount * push.pointCount,
                                     all ? 1u : push.pointCount);
            Patch from = startingPatch(p, cover, startOf);
            if (near) factors[s % kReplicates] += emitterFormFactor(from.position, from.shading, e);
            EmitterSample y = emitterSample(from.position, from.shading, e, sobolPoint(turn, seed));
            // Below the geometric horizon the point is hidden, and not asked for.
            bool above = dot(y.point - from.position, from.normal) > from.offset;
            point = vec4(y.point + off, above ? y.factor : -y.factor);
        }
        VEC4_AT(push.targets, (base + s) * kChunk + lane) = point;
    }
    if (near) {
        factors *= float(kReplicates) / float(points);
        whole = 0.25 * (factors.x + factors.y + factors.z + factors.w);
        light = e.radiance * (whole / probability);
        if (all) {
            VEC4_AT(push.picks, ((push.firstNear + chunk) * push.pickCount + pick) * kChunk + lane) = factors;
            whole = -whole;
        }
    }
    VEC4_AT(push.picks, (chunk * push.pickCount + pick) * kChunk + lane) = vec4(light, whole);
}
