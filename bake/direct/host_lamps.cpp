#include "bake/direct/host_lamps.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace relume {
namespace {

using shader::kChunk;
using shader::kReplicates;
using shader::Lamp;
using shader::Patch;

// Says which of the samples is made, and of what.
struct SampleDesc {
    Lamp lamp;
    const ChunkStarts::Points& fading; // where it fades as it does for each patch
    uint32_t number;                   // among those of all sample passes
    float reach;
};

// Makes one sample of all patches, in a form that compilers turn into vector code; the light's type is known
// to them. It is always inlined, to be compiled once for each instruction set.
template<uint32_t kType>
[[gnu::always_inline]] inline void sampleLanes(const PatchLanes& lanes, const SampleDesc& desc,
                                               TargetLanes& out) {
    Lamp lamp = desc.lamp;
    lamp.type = kType;
    const uint32_t index = shader::replicateIndex(desc.number);
#pragma GCC ivdep
    for (uint32_t i = 0; i < kChunk; ++i) {
        Patch p;
        p.position = {lanes.at.x[i], lanes.at.y[i], lanes.at.z[i]};
        p.normal = {lanes.nx[i], lanes.ny[i], lanes.nz[i]};
        p.shading = {lanes.sx[i], lanes.sy[i], lanes.sz[i]};
        const uint32_t seed = shader::lampSeed(lamp, lanes.key[i], desc.number);
        const glm::vec3 fading(desc.fading.x[i], desc.fading.y[i], desc.fading.z[i]);
        const shader::LampSample s =
            shader::lampSample(lamp, p, fading, shader::sobolPoint(index, seed), desc.reach);
        const float height = glm::dot(s.target - p.position, p.normal);
        const bool traced = (lanes.sends[i] & (height > lanes.offset[i] ? 1u : 0u)) != 0; // sends: 0 or 1
        out.x[i] = s.target.x, out.y[i] = s.target.y, out.z[i] = s.target.z;
        out.w[i] = traced ? s.factor : -s.factor;
    }
}

[[gnu::always_inline]] inline void sampleLamp(const PatchLanes& lanes, const SampleDesc& desc,
                                              TargetLanes& out) {
    switch (desc.lamp.type) {
    case shader::kLampSun:
        return sampleLanes<shader::kLampSun>(lanes, desc, out);
    case shader::kLampRectangle:
        return sampleLanes<shader::kLampRectangle>(lanes, desc, out);
    case shader::kLampDisc:
        return sampleLanes<shader::kLampDisc>(lanes, desc, out);
    case shader::kLampSpot:
        return sampleLanes<shader::kLampSpot>(lanes, desc, out);
    default:
        return sampleLanes<shader::kLampPoint>(lanes, desc, out);
    }
}

using SampleLamp = void (*)(const PatchLanes&, const SampleDesc&, TargetLanes&);

void sampleLampPlain(const PatchLanes& lanes, const SampleDesc& desc, TargetLanes& out) {
    sampleLamp(lanes, desc, out);
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) void sampleLampAvx2(const PatchLanes& lanes, const SampleDesc& desc,
                                                    TargetLanes& out) {
    sampleLamp(lanes, desc, out);
}
SampleLamp chooseSampleLamp() {
    return __builtin_cpu_supports("avx2") ? sampleLampAvx2 : sampleLampPlain;
}
#else
SampleLamp chooseSampleLamp() {
    return sampleLampPlain;
}
#endif

void sampleChunk(const HostLamps& work, uint32_t chunk, SampleLamp sample) {
    const HostPoints& on = work.points;
    const size_t firstPatch = on.firstPatch(chunk);
    PatchLanes lanes;
    if (!lanes.load(on, firstPatch)) {
        std::fill_n(on.targetsOf(chunk, 0), size_t{on.targetCount} * kChunk, glm::vec4(0.0f));
        return;
    }
    ChunkStarts starts;
    starts.setPatches(on.patches + firstPatch, on.covers ? on.covers + firstPatch : nullptr);
    TargetLanes out;
    for (const Lamp& lamp : work.lamps) {
        std::array<uint32_t, kChunk> uneven;
        bool even = true;
        for (uint32_t i = 0; i < kChunk; ++i) {
            uneven[i] = shader::lampUnevenness(lamp, lanes.middle.at(i), lanes.size[i]);
            even = even && uneven[i] == shader::kLightEven;
        }
        ChunkStarts::Points fading = lanes.middle;
        const uint32_t samples = lamp.samples * on.together, first = lamp.firstTarget * on.together;
        for (uint32_t s = 0; s < samples; ++s) {
            if (lamp.samples == 1 && s > 0) { // it has the same sample in each sample pass
                std::fill_n(on.targetsOf(chunk, first + s), kChunk, glm::vec4(0.0f));
                continue;
            }
            const uint32_t number = on.samplePass * samples + s;
            starts.make(number, lanes.at);
            for (uint32_t i = 0; !even && i < kChunk; ++i)
                fading.set(i, shader::fadingPlace(uneven[i], lanes.middle.at(i), lanes.at.at(i)));
            sample(lanes, {lamp, fading, number, work.reach}, out);
            out.store(on.targetsOf(chunk, first + s), lanes, s / lamp.samples);
        }
    }
}

// The light of one analytic light, and what its samples have reached.
struct Gathered {
    std::array<float, kReplicates> light{}; // per unit of the light's colour, of each replicate
    bool reached = false, hidden = false;
    bool shareless = false; // no share of the whole light can be known
};

// Holds what is known of a patch.
struct Receiver {
    uint32_t lane;    // in its chunk
    uint32_t taken;   // sample passes
    glm::vec3 normal; // for shading
    shader::TexelSpread spread;
};

Gathered gatherLamp(const HostPoints& on, const Lamp& lamp, uint32_t chunk, const Receiver& receiver) {
    const uint32_t lane = receiver.lane, taken = receiver.taken;
    const uint32_t samples = lamp.samples > 1 ? lamp.samples * taken : 1;
    Gathered result;
    std::array<float, kReplicates> part{}, seen{};
    float all = 0.0f, visible = 0.0f;
    for (uint32_t s = 0; s < samples; ++s) {
        const uint32_t target = lamp.firstTarget * on.together + s;
        const float w = on.targetsOf(chunk, target)[lane].w, light = std::abs(w);
        const bool reached =
            w > 0.0f && (on.bitsOf(chunk, target)[lane] >> (target % kTargetsPerWord) & 1) != 0;
        part[s % kReplicates] += light;
        all += light;
        result.reached = result.reached || (light != 0.0f && reached);
        result.hidden = result.hidden || (light != 0.0f && !reached);
        if (!reached) continue;
        seen[s % kReplicates] += light;
        visible += light;
    }
    if (lamp.samples == 1) {
        result.light.fill(seen[0]);
        return result;
    }
    const float whole = shader::lampWhole(lamp, receiver.spread, receiver.normal);
    // A few samples may have missed all of a light that is uneven.
    const bool uneven =
        shader::lampUnevenness(lamp, receiver.spread.middle, receiver.spread.size) == shader::kLightUneven;
    result.shareless = whole < 0.0f && (all > 0.0f || uneven);
    const float count = static_cast<float>(samples) / static_cast<float>(kReplicates);
    for (uint32_t q = 0; q < kReplicates; ++q)
        result.light[q] =
            whole >= 0.0f ? shader::seenLight(whole, count, part[q], seen[q], all, visible) : seen[q] / count;
    return result;
}

void gatherChunk(const HostLamps& work, uint32_t chunk) {
    for (uint32_t lane = 0; lane < kChunk; ++lane) {
        const size_t patch = work.points.firstPatch(chunk) + lane;
        if (!takesLight(work.points, patch)) continue;
        const Receiver receiver{lane, work.points.takenSamplePasses(patch),
                                work.points.patches[patch].shading, work.points.spreadOf(patch)};
        HostGathered gathered;
        for (size_t k = 0; k < work.lamps.size(); ++k) {
            const Lamp& lamp = work.lamps[k];
            const Gathered one = gatherLamp(work.points, lamp, chunk, receiver);
            for (uint32_t q = 0; q < kReplicates; ++q)
                gathered.value[q] += lamp.color * (static_cast<float>(receiver.taken) * one.light[q]);
            gathered.note(k, one.reached, one.hidden);
            if (one.shareless) gathered.reached = gathered.hidden = ~0u;
        }
        addGathered(work.points, patch, gathered);
    }
}

} // namespace

void sampleLamps(WorkerPool& pool, const HostLamps& work) {
    static const SampleLamp sample = chooseSampleLamp();
    pool.run(work.points.chunkCount, [&](uint32_t chunk) { sampleChunk(work, chunk, sample); });
}

void gatherLamps(WorkerPool& pool, const HostLamps& work) {
    pool.run(work.points.chunkCount, [&](uint32_t chunk) { gatherChunk(work, chunk); });
}

} // namespace relume
