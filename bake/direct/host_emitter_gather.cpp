#include "bake/direct/host_emitters.h"

#include <array>
#include <cmath>

namespace relume {
namespace {

using shader::kChunk;
using shader::kReplicates;
using Lane = PatchLanes::Lane;

// Sums over a chunk's points on one polygon.
struct PointSums {
    std::array<Lane, kReplicates> part{}, seen{}; // of what each replicate's points bring, and of those seen
    Lane all{}, visible{};
};

PointSums sumPoints(const HostEmitters& work, uint32_t chunk, uint32_t pick) {
    PointSums sums;
    for (uint32_t s = 0; s < work.allPoints(); ++s) {
        const uint32_t target = pick * work.allPoints() + s, q = s % kReplicates;
        const uint32_t bit = 1u << (target % kTargetsPerWord);
        const float* factors = &work.points.targetsOf(chunk, target)->w;
        const uint32_t* bits = work.points.bitsOf(chunk, target);
        for (uint32_t i = 0; i < kChunk; ++i) {
            const float w = factors[i * glm::vec4::length()], f = std::abs(w);
            const float v = w > 0.0f && (bits[i] & bit) != 0 ? f : 0.0f;
            sums.part[q][i] += f;
            sums.seen[q][i] += v;
            sums.all[i] += f;
            sums.visible[i] += v;
        }
    }
    return sums;
}

void gatherChunk(const HostEmitters& work, uint32_t chunk) {
    const size_t count = work.polygons.size();
    const size_t firstPatch = work.points.firstPatch(chunk);
    std::array<uint32_t, kChunk> taken;
    for (uint32_t i = 0; i < kChunk; ++i)
        taken[i] = work.points.takenSamplePasses(firstPatch + i);
    std::array<HostGathered, kChunk> gathered;
    for (uint32_t k = 0; k < count; ++k) {
        const PointSums sums = sumPoints(work, chunk, k);
        const glm::vec4* picks = work.picks + (chunk * count + k) * kChunk;
        for (uint32_t i = 0; i < kChunk; ++i) {
            const glm::vec3 light(picks[i]);
            const float whole = picks[i].w;
            if (light == glm::vec3(0.0f) || whole == 0.0f) continue;
            // Each replicate's points start elsewhere, and know what is near from there.
            const glm::vec4* const near =
                whole < 0.0f ? &work.near[(chunk * count + k) * kChunk + i] : nullptr;
            const float points =
                static_cast<float>(work.pointCount * taken[i] / kReplicates); // of each replicate
            gathered[i].note(k, sums.visible[i] > 0.0f, sums.visible[i] < sums.all[i]);
            for (uint32_t q = 0; q < kReplicates; ++q)
                gathered[i].value[q] +=
                    light *
                    (static_cast<float>(taken[i]) *
                     shader::seenLight(near ? (*near)[static_cast<int>(q)] : whole, points, sums.part[q][i],
                                       sums.seen[q][i], sums.all[i], sums.visible[i]) /
                     std::abs(whole));
        }
    }
    for (uint32_t i = 0; i < kChunk; ++i) {
        const size_t patch = firstPatch + i;
        if (takesLight(work.points, patch)) addGathered(work.points, patch, gathered[i]);
    }
}

} // namespace

void gatherEmitters(WorkerPool& pool, const HostEmitters& work) {
    pool.run(work.points.chunkCount, [&](uint32_t chunk) { gatherChunk(work, chunk); });
}

} // namespace relume
