#include "bake/direct/host_points.h"

#include <atomic>

namespace relume {
namespace {

using shader::kChunk;
using shader::kReplicates;
using shader::Patch;

constexpr size_t kLightBits = 32; // lib/light/penumbra.glsl

void addBits(uint32_t& to, uint32_t bits) {
    const std::atomic_ref<uint32_t> all(to);
    if ((bits & ~all.load(std::memory_order_relaxed)) != 0) all.fetch_or(bits, std::memory_order_relaxed);
}

} // namespace

HostPoints hostPoints(const LightBuffers& light, const SegmentWork& segments, uint32_t together,
                      const Penumbra* penumbra, const PointsOnCpu& on) {
    return {.patches = light.patches.as<Patch>(),
            .covers = segments.covers ? segments.covers->as<shader::PatchCover>() : nullptr,
            .targets = segments.targets->as<glm::vec4>(),
            .bits = segments.bits->as<uint32_t>(),
            .parts = penumbra ? penumbra->parts.as<uint32_t>() : nullptr,
            .penumbra = penumbra ? penumbra->lights.as<glm::uvec2>() : nullptr,
            .sums = on.sums.as<glm::vec4>(),
            .newSums = on.newSums,
            .direct = on.direct.as<glm::vec4>(),
            .chunks = segments.chunks ? segments.chunks->as<uint32_t>() : nullptr,
            .firstChunk = segments.firstChunk,
            .chunkCount = segments.chunkCount,
            .targetCount = segments.targetCount,
            .samplePass = segments.samplePass,
            .together = together,
            .patchCount = light.chunkCount * kChunk,
            .scale = 1.0f / static_cast<float>(kReplicates * together * (segments.samplePass + 1))};
}

const uint32_t* HostPoints::bitsOf(uint32_t chunk, uint32_t target) const {
    const uint32_t words = (targetCount + kTargetsPerWord - 1) / kTargetsPerWord;
    return bits + (size_t{chunk} * words + target / kTargetsPerWord) * kChunk;
}

uint32_t HostPoints::takenSamplePasses(size_t patch) const {
    // The first sample pass is for all, and others of its threads write these notes meanwhile.
    if (!penumbra || samplePass == 0) return together;
    const glm::uvec2& lights = penumbra[parts[patch]];
    if ((lights.x & lights.y) != 0) return together;
    return shader::allTakeSamplePass(samplePass * together) ? 1 : 0;
}

shader::TexelSpread HostPoints::spreadOf(size_t patch) const {
    return shader::texelSpread(patches[patch], covers ? covers[patch] : shader::PatchCover{});
}

void HostPoints::noteLights(size_t patch, uint32_t reached, uint32_t hidden) const {
    if (!penumbra || samplePass != 0) return;
    glm::uvec2& lights = penumbra[parts[patch]];
    addBits(lights.x, reached);
    addBits(lights.y, hidden);
}

bool PatchLanes::load(const HostPoints& work, size_t first) {
    bool any = false;
    unalike = false;
    for (uint32_t i = 0; i < kChunk; ++i) {
        const Patch& p = work.patches[first + i];
        const shader::TexelSpread t = work.spreadOf(first + i);
        middle.set(i, t.middle);
        for (uint32_t k = 0; k < shader::kSpreadPoints; ++k)
            spread[k].set(i, shader::spreadPoint(t, k));
        nx[i] = p.normal.x, ny[i] = p.normal.y, nz[i] = p.normal.z;
        sx[i] = p.shading.x, sy[i] = p.shading.y, sz[i] = p.shading.z;
        offset[i] = p.offset, size[i] = t.size;
        key[i] = shader::seedKey(p);
        taken[i] = work.takenSamplePasses(first + i);
        unalike = unalike || taken[i] != work.together;
        const bool takesPart = taken[i] > 0;
        sends[i] = takesPart && (p.flags & shader::kPatchSends) != 0 ? 1 : 0;
        any = any || takesPart;
    }
    return any;
}

void TargetLanes::store(glm::vec4* targets) const {
    for (uint32_t i = 0; i < kChunk; ++i)
        targets[i] = {x[i], y[i], z[i], w[i]};
}

void TargetLanes::store(glm::vec4* targets, const PatchLanes& lanes, uint32_t samplePass) {
    for (uint32_t i = 0; lanes.unalike && i < kChunk; ++i)
        w[i] = samplePass < lanes.taken[i] ? w[i] : 0.0f;
    store(targets);
}

uint32_t HostGathered::bitOf(size_t light) {
    return 1u << (light % kLightBits);
}

void HostGathered::note(size_t light, bool isReached, bool isHidden) {
    const uint32_t bit = bitOf(light);
    if (isReached) reached |= bit;
    if (isHidden) hidden |= bit;
}

bool takesLight(const HostPoints& work, size_t patch) {
    if ((work.patches[patch].flags & shader::kPatchSends) != 0 && work.takenSamplePasses(patch) > 0)
        return true;
    for (size_t q = 0; work.newSums && q < kReplicates; ++q)
        work.sums[q * work.patchCount + patch] = glm::vec4(0.0f);
    return false;
}

void addGathered(const HostPoints& work, size_t patch, const HostGathered& gathered) {
    work.noteLights(patch, gathered.reached, gathered.hidden);
    glm::vec3 total(0.0f);
    for (size_t q = 0; q < kReplicates; ++q) {
        glm::vec4& sum = work.sums[q * work.patchCount + patch];
        sum = glm::vec4((work.newSums ? glm::vec3(0.0f) : glm::vec3(sum)) + gathered.value[q], 0.0f);
        total += glm::vec3(sum);
    }
    work.direct[patch] = glm::vec4(glm::max(total * work.scale, 0.0f), 1.0f);
}

} // namespace relume
