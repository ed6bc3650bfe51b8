#include "bake/direct/host_lamps.h"

#include "bake/trace/chunk_starts.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

namespace relume {
namespace {

using shader::kChunk;
using shader::kReplicates;
using shader::Lamp;
using shader::Patch;

constexpr uint32_t kTargetsPerWord = 32; // lib/rays/segments.glsl
constexpr uint32_t kLightBits = 32;      // lib/light/penumbra.glsl

// Does what lib/light/penumbra_sample_passes.glsl does.
bool leftOut(const HostLamps& work, size_t index) {
    if (!work.penumbra || shader::allTakeSamplePass(work.samplePass)) return false;
    const glm::uvec2& lights = work.penumbra[work.parts[index]];
    return (lights.x & lights.y) == 0;
}

void addBits(uint32_t& to, uint32_t bits) {
    const std::atomic_ref<uint32_t> all(to);
    if ((bits & ~all.load(std::memory_order_relaxed)) != 0) all.fetch_or(bits, std::memory_order_relaxed);
}

// A chunk by component.
struct PatchLanes {
    using Lane = ChunkStarts::Lane;
    ChunkStarts::Points at; // where the sample starts
    Lane px, py, pz, nx, ny, nz, sx, sy, sz, offset;
    std::array<uint32_t, kChunk> key, sends;
};

struct TargetLanes {
    PatchLanes::Lane x, y, z, w;
};

// Says which of the samples is made, and of what.
struct SampleDesc {
    Lamp lamp;
    uint32_t number; // among those of all sample passes
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
        const glm::vec3 own(lanes.px[i], lanes.py[i], lanes.pz[i]);
        const shader::LampSample s =
            shader::lampSample(lamp, p, own, shader::sobolPoint(index, seed), desc.reach);
        const float height = glm::dot(s.target - p.position, p.normal);
        const bool traced = (lanes.sends[i] != 0) & (height > lanes.offset[i]);
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

// Loads a chunk's patches and returns whether any of them takes part.
bool load(const HostLamps& work, size_t first, PatchLanes& lanes) {
    bool any = false;
    for (uint32_t i = 0; i < kChunk; ++i) {
        const Patch& p = work.patches[first + i];
        lanes.px[i] = p.position.x, lanes.py[i] = p.position.y, lanes.pz[i] = p.position.z;
        lanes.nx[i] = p.normal.x, lanes.ny[i] = p.normal.y, lanes.nz[i] = p.normal.z;
        lanes.sx[i] = p.shading.x, lanes.sy[i] = p.shading.y, lanes.sz[i] = p.shading.z;
        lanes.offset[i] = p.offset;
        lanes.key[i] = shader::seedKey(p);
        const bool takesPart = !leftOut(work, first + i);
        lanes.sends[i] = takesPart && (p.flags & shader::kPatchSends) != 0 ? 1 : 0;
        any = any || takesPart;
    }
    return any;
}

void sampleChunk(const HostLamps& work, uint32_t chunk, SampleLamp sample) {
    const size_t first = size_t{work.firstChunk + chunk} * kChunk;
    glm::vec4* targets = work.targets + size_t{chunk} * work.targetCount * kChunk;
    PatchLanes lanes;
    if (!load(work, first, lanes)) {
        std::fill_n(targets, size_t{work.targetCount} * kChunk, glm::vec4(0.0f));
        return;
    }
    ChunkStarts starts;
    starts.setPatches(work.patches + first, work.covers ? work.covers + first : nullptr);
    TargetLanes out;
    for (const Lamp& lamp : work.lamps) {
        for (uint32_t s = 0; s < lamp.samples; ++s) {
            const uint32_t number = work.samplePass * lamp.samples + s;
            starts.make(number, lanes.at);
            sample(lanes, {lamp, number, work.reach}, out);
            glm::vec4* to = targets + size_t{lamp.firstTarget + s} * kChunk;
            for (uint32_t i = 0; i < kChunk; ++i)
                to[i] = {out.x[i], out.y[i], out.z[i], out.w[i]};
        }
    }
}

// The light of one analytic light, and what its samples have reached.
struct Gathered {
    std::array<float, kReplicates> light{}; // per unit of the light's colour, of each replicate
    bool reached = false, hidden = false;
    bool shareless = false; // no share of the whole light can be known
};

Gathered gatherLamp(const Lamp& lamp, const Patch& p, const glm::vec4* targets, const uint32_t* bits) {
    Gathered result;
    std::array<float, kReplicates> part{}, seen{};
    float all = 0.0f, visible = 0.0f;
    for (uint32_t s = 0; s < lamp.samples; ++s) {
        const uint32_t target = lamp.firstTarget + s;
        const float w = targets[size_t{target} * kChunk].w, light = std::abs(w);
        const bool reached =
            w > 0.0f &&
            (bits[size_t{target / kTargetsPerWord} * kChunk] >> (target % kTargetsPerWord) & 1) != 0;
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
    const float whole = shader::lampWhole(lamp, p);
    result.shareless = whole < 0.0f && all > 0.0f;
    const float count = static_cast<float>(lamp.samples) / static_cast<float>(kReplicates);
    for (uint32_t q = 0; q < kReplicates; ++q)
        result.light[q] =
            whole >= 0.0f ? shader::seenLight(whole, count, part[q], seen[q], all, visible) : seen[q] / count;
    return result;
}

void gatherChunk(const HostLamps& work, uint32_t chunk) {
    const uint32_t words = (work.targetCount + kTargetsPerWord - 1) / kTargetsPerWord;
    for (uint32_t lane = 0; lane < kChunk; ++lane) {
        const size_t index = size_t{work.firstChunk + chunk} * kChunk + lane;
        const Patch& p = work.patches[index];
        if ((p.flags & shader::kPatchSends) == 0 || leftOut(work, index)) {
            for (size_t q = 0; work.newSums && q < kReplicates; ++q)
                work.sums[q * work.patchCount + index] = glm::vec4(0.0f);
            continue;
        }
        const glm::vec4* targets = work.targets + size_t{chunk} * work.targetCount * kChunk + lane;
        const uint32_t* bits = work.bits + size_t{chunk} * words * kChunk + lane;
        std::array<glm::vec3, kReplicates> value{};
        uint32_t reached = 0, hidden = 0;
        for (size_t k = 0; k < work.lamps.size(); ++k) {
            const Lamp& lamp = work.lamps[k];
            const Gathered gathered = gatherLamp(lamp, p, targets, bits);
            for (uint32_t q = 0; q < kReplicates; ++q)
                value[q] += lamp.color * gathered.light[q];
            const uint32_t bit = 1u << (k % kLightBits);
            if (gathered.reached) reached |= bit;
            if (gathered.hidden) hidden |= bit;
            if (gathered.shareless) reached = hidden = ~0u;
        }
        if (work.penumbra && work.samplePass == 0) {
            glm::uvec2& lights = work.penumbra[work.parts[index]];
            addBits(lights.x, reached);
            addBits(lights.y, hidden);
        }
        glm::vec3 total(0.0f);
        for (size_t q = 0; q < kReplicates; ++q) {
            glm::vec4& sum = work.sums[q * work.patchCount + index];
            sum = glm::vec4((work.newSums ? glm::vec3(0.0f) : glm::vec3(sum)) + value[q], 0.0f);
            total += glm::vec3(sum);
        }
        work.direct[index] = glm::vec4(glm::max(total * work.scale, 0.0f), 1.0f);
    }
}

} // namespace

void sampleLamps(WorkerPool& pool, const HostLamps& work) {
    static const SampleLamp sample = chooseSampleLamp();
    pool.run(work.chunkCount, [&](uint32_t chunk) { sampleChunk(work, chunk, sample); });
}

void gatherLamps(WorkerPool& pool, const HostLamps& work) {
    pool.run(work.chunkCount, [&](uint32_t chunk) { gatherChunk(work, chunk); });
}

} // namespace relume
