#include "bake/gather/host_links.h"

#include "bake/base/host_lanes.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <numbers>
#include <vector>

namespace relume {
namespace {

using shader::kChunk;
using shader::kReplicates;

glm::vec4 withAlpha(const Float4& rgb, float alpha) {
    return {rgb[0], rgb[1], rgb[2], alpha};
}

void gatherChunkLinks(const HostLinks& work, uint32_t chunk) {
    static const glm::vec4 kNothing(0.0f); // what other links without a patch at their end bring
    const glm::vec4 sky(work.sky, 0.0f);
    const uint32_t* links = work.links + size_t{chunk} * work.samples * kChunk;
    const float samples = static_cast<float>(work.samples);
    for (uint32_t lane = 0; lane < kChunk; ++lane) {
        const size_t index = size_t{work.firstChunk + chunk} * kChunk + lane;
        Float4 sum[kReplicates] = {};
        for (uint32_t k = 0; k < work.samples; k += kReplicates) {
            for (uint32_t q = 0; q < kReplicates; ++q) {
                const uint32_t link = links[(k + q) * kChunk + lane];
                Float4 light;
                load(light, link < shader::kLinkFirstSpecial ? work.radiance[link]
                            : link == shader::kLinkSky       ? sky
                                                             : kNothing);
                sum[q] += light;
            }
        }
        if (work.ligOut) {
            Float4 total = (sum[0] + sum[1] + sum[2] + sum[3]) / samples;
            if (work.direct) {
                Float4 direct;
                load(direct, work.direct[index]);
                total += direct;
            }
            work.ligOut[index] = withAlpha(total, 1.0f);
        }
        if (!work.sums) continue;
        for (uint32_t q = 0; q < kReplicates; ++q) {
            glm::vec4& out = work.sums[size_t{q} * work.patchCount + index];
            Float4 before;
            load(before, work.newSums ? kNothing : out);
            out = withAlpha(before + sum[q], work.newSums ? 0.0f : out.w);
        }
    }
}

void sendChunk(const HostSend& work, uint32_t chunk) {
    const bool full =
        work.full[chunk] != 0; // else patches are looked at, three times as much memory as all else
    glm::vec4 change(0.0f);
    for (size_t index = size_t{chunk} * kChunk, end = index + kChunk; index < end; ++index) {
        const uint32_t flags = full ? shader::kPatchSends : work.patches[index].flags;
        const bool sends = (flags & shader::kPatchSends) != 0;
        const glm::vec3 light(work.light[index]);
        work.radiance[index] =
            sends ? glm::vec4(work.reflectivity * glm::vec3(work.albedo[index]) * light, 0.0f)
                  : glm::vec4(0.0f);
        if (!work.changes || !shader::patchIsShown(flags)) continue;
        const glm::vec3 before(work.before[index]), by = light - before;
        const float last = work.isFirst ? before.r + before.g + before.b : shader::relativeChange(light, by);
        change += glm::vec4(glm::dot(by, by), light.r + light.g + light.b, 1.0f, last);
    }
    if (work.changes) work.changes[chunk] = change;
}

} // namespace

void gatherLinks(WorkerPool& pool, const HostLinks& work) {
    pool.run(work.chunkCount, [&](uint32_t chunk) { gatherChunkLinks(work, chunk); });
}

void sendLight(WorkerPool& pool, const HostSend& work) {
    pool.run(work.chunkCount, [&](uint32_t chunk) { sendChunk(work, chunk); });
}

} // namespace relume
