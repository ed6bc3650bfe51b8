#include "bake/baker/cover_search.h"

#include <algorithm>
#include <bit>

#include "assets/base/clock.h"
#include "assets/base/portions.h"
#include "bake/base/batch_rate.h"
#include "bake/base/chunk_order.h"
#include "bake/surface/patch_cover.h"
#include "bake/vk/commands.h"

namespace relume {
namespace {

using shader::kChunk;
using shader::kCoverCells;
using shader::kCoverWhole;

// The aim of one submit [ms]; a wish to stop waits for as long.
constexpr double kCoverBatchMs = 20.0;
// A batch has at most so many chunks, whose targets are 4 MiB, on a GPU, which fewer would not fill, 64 MiB.
constexpr uint32_t kMostCoverChunks = 4096, kMostCoverChunksOfSoftware = 256;
constexpr uint32_t kPlaces = shader::kCoverEdge * shader::kCoverEdge;
static_assert(kRimPlaces <= kPlaces && kPlaces <= kTargetsPerWord);
// A place nearer to the patch's own point than this share of the texel is seen without asking.
constexpr float kHere = 1e-3f;
// A thread takes so many patches at a time where little is done to each.
constexpr size_t kLongPortion = size_t{1} << 15;

uint32_t mostCoverChunks(uint32_t chunks, bool software) {
    return std::min(chunks, software ? kMostCoverChunksOfSoftware : kMostCoverChunks);
}

// Asks which places of texels the patches' own points see.
class CoverBatches {
public:
    explicit CoverBatches(const CoverSearch& search)
        : search_(search),
          most_(mostCoverChunks(search.patches.chunkCount(), search.device.info().software())),
          commands_(search.device),
          targets_(search.device, {.size = uint64_t{most_} * kPlaces * kChunk * sizeof(glm::vec4),
                                   .memory = vk::Memory::Host,
                                   .name = "places in texels"}),
          bits_(search.device, {.size = uint64_t{most_} * kChunk * sizeof(uint32_t),
                                .memory = vk::Memory::Host,
                                .name = "seen places"}),
          rays_(search.device, {.size = shader::kRayCounters * sizeof(uint32_t), .name = "rays"}),
          rate_(!search.device.info().software()) {}

    // Returns a bit for each of the places that these patches (ascending) see; `placeOf` tells where they
    // are.
    std::vector<uint32_t> seen(std::span<const uint32_t> which, uint32_t places,
                               const std::function<glm::vec2(uint32_t)>& placeOf) {
        std::vector<uint32_t> result(which.size(), 0);
        for (size_t begin = 0; begin < which.size();) {
            if (search_.onBatch)
                search_.onBatch(static_cast<double>(begin) / static_cast<double>(which.size()));
            const auto wanted = static_cast<uint32_t>(
                std::clamp(rate_.wanted(kCoverBatchMs), 1.0, static_cast<double>(most_)));
            const uint32_t first = which[begin] / kChunk;
            const auto rest = which.subspan(begin);
            const auto beyond = std::partition_point(
                rest.begin(), rest.end(), [&](uint32_t patch) { return patch / kChunk < first + wanted; });
            const auto batch = rest.first(static_cast<size_t>(beyond - rest.begin()));
            const uint32_t count = batch.back() / kChunk - first + 1;
            const auto start = Clock::now();
            ask(batch, {first, count}, places, placeOf, &result[begin]);
            rate_.note(count, kCoverBatchMs, secondsSince(start));
            begin += batch.size();
        }
        return result;
    }

private:
    // Sets the bits of what each of these patches sees; none is set before.
    void ask(std::span<const uint32_t> which, ChunkRange range, uint32_t places,
             const std::function<glm::vec2(uint32_t)>& placeOf, uint32_t* seen) {
        auto* const targets = targets_.as<glm::vec4>();
        WorkerPool& pool = search_.device.workers();
        const size_t perChunk = size_t{places} * kChunk;
        pool.run(range.count,
                 [&](uint32_t chunk) { std::fill_n(targets + chunk * perChunk, perChunk, glm::vec4(0.0f)); });
        const auto aim = [&](size_t index) {
            const uint32_t patch = which[index];
            const shader::Patch& p = search_.patches.scene.patches[patch];
            const shader::PatchCover& cover = search_.patches.covers[patch];
            const float near = kHere * (glm::length(cover.du) + glm::length(cover.dv));
            const size_t chunk = patch / kChunk - range.first;
            for (uint32_t k = 0; k < places; ++k) {
                const glm::vec3 way = shader::coverWay(cover, placeOf(k));
                if (glm::length(way) <= near)
                    seen[index] |= 1u << k; // needs no ray
                else
                    targets[chunk * perChunk + size_t{k} * kChunk + patch % kChunk] =
                        glm::vec4(p.position + way + p.offset * p.normal, 1.0f);
            }
        };
        constexpr size_t kPortion = 512; // patches that a thread looks at, at a time
        runPortions(pool, which.size(), kPortion, [&](size_t begin, size_t end) {
            for (size_t i = begin; i < end; ++i)
                aim(i);
        });
        const bool records = search_.tracer.records();
        VkCommandBuffer cmd = records ? commands_.begin() : VK_NULL_HANDLE;
        search_.tracer.segments(cmd, {.firstChunk = range.first,
                                      .chunkCount = range.count,
                                      .targetCount = places,
                                      .targets = &targets_,
                                      .bits = &bits_,
                                      .rays = &rays_});
        if (records) {
            vk::hostBarrier(cmd);
            commands_.run();
        }
        const auto* const bits = bits_.as<uint32_t>();
        runPortions(pool, which.size(), kLongPortion, [&](size_t begin, size_t end) {
            for (size_t i = begin; i < end; ++i)
                seen[i] |= bits[which[i] - range.first * kChunk];
        });
    }

    const CoverSearch& search_;
    uint32_t most_;
    vk::Commands commands_;
    vk::Buffer targets_, bits_, rays_;
    BatchRate rate_;
};

} // namespace

std::vector<uint32_t> coveredPatches(const PatchSet& patches, WorkerPool& pool) {
    return numbersWhere(pool, patches.coverCells.size(),
                        [&](size_t patch) { return patches.coverCells[patch] != 0; });
}

std::vector<uint32_t> searchCovers(const CoverSearch& search, std::span<const uint32_t> which) {
    if (which.empty()) return {};
    WorkerPool& pool = search.device.workers();
    std::vector<shader::PatchCover>& covers = search.patches.covers;
    // Numbers count in `which` here.
    const auto patchesAt = [&](const std::vector<uint32_t>& numbers) {
        std::vector<uint32_t> patches(numbers.size());
        runPortions(pool, numbers.size(), kLongPortion, [&](size_t begin, size_t end) {
            for (size_t i = begin; i < end; ++i)
                patches[i] = which[numbers[i]];
        });
        return patches;
    };
    std::vector<uint32_t> before(which.size());
    std::vector<uint8_t> asks(which.size()); // for each cell by itself
    runPortions(pool, which.size(), kLongPortion, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            uint32_t& cells = covers[which[i]].cells;
            before[i] = cells;
            cells = search.patches.coverCells[which[i]];
            asks[i] = (cells & kCoverWhole) == 0;
        }
    });
    CoverBatches batches(search);
    // As a rule nothing stands in a texel whose whole rim is seen.
    const std::vector<uint32_t> whole = numbersWhere(pool, which.size(), [&](size_t i) { return !asks[i]; });
    const std::vector<uint32_t> rims = batches.seen(patchesAt(whole), kRimPlaces, rimPlace);
    runPortions(pool, whole.size(), kLongPortion, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i)
            asks[whole[i]] = std::popcount(rims[i] & ((1u << kRimPlaces) - 1)) < int{kRimPlaces};
    });
    const std::vector<uint32_t> parts =
        patchesAt(numbersWhere(pool, which.size(), [&](size_t i) { return asks[i]; }));
    const std::vector<uint32_t> cells = batches.seen(parts, kPlaces, shader::cellPlace);
    runPortions(pool, parts.size(), kLongPortion, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i)
            covers[parts[i]].cells &= cells[i] & kCoverCells;
    });
    return patchesAt(
        numbersWhere(pool, which.size(), [&](size_t i) { return covers[which[i]].cells != before[i]; }));
}

uint64_t coverSearchBytes(uint32_t chunks, bool software) {
    return uint64_t{mostCoverChunks(chunks, software)} * kChunk *
               (kPlaces * sizeof(glm::vec4) + sizeof(uint32_t)) +
           shader::kRayCounters * sizeof(uint32_t);
}

} // namespace relume
