#include "bake/validity/cover_search.h"

#include <algorithm>
#include <bit>
#include <numeric>
#include <optional>

#include "assets/base/clock.h"
#include "assets/base/error.h"
#include "assets/base/portions.h"
#include "bake/base/batch_rate.h"
#include "bake/base/chunk_order.h"
#include "bake/base/retrace_types.h"
#include "bake/vk/commands.h"
#include "bake/vk/program.h"

namespace relume {
namespace {

using shader::kChunk;
using shader::kCoverCells;
using shader::kCoverWhole;
using shader::kRimPlaces;

// The aim of one submit [ms]; a wish to stop waits for as long.
constexpr double kCoverBatchMs = 20.0;
// A batch has at most so many chunks, whose targets are 4 MiB, on a GPU, which fewer would not fill, 64 MiB.
constexpr uint32_t kMostCoverChunks = 4096, kMostCoverChunksOfSoftware = 256;
constexpr uint32_t kPlaces = shader::kCoverEdge * shader::kCoverEdge;
static_assert(kRimPlaces < kPlaces && kPlaces <= kTargetsPerWord);

// A texel is asked for places on its rim, or for the middles of its cells.
enum class Places { Rim, Cells };
constexpr uint32_t countOf(Places places) {
    return places == Places::Rim ? kRimPlaces : kPlaces;
}
// A thread takes so many patches at a time where little is done to each.
constexpr size_t kLongPortion = size_t{1} << 15;

uint32_t mostCoverChunks(uint32_t chunks, bool software) {
    return std::min(chunks, software ? kMostCoverChunksOfSoftware : kMostCoverChunks);
}

} // namespace

// Asks which places of texels the patches' own points see. Segments to them are made where they are traced.
class CoverSearcher::Batches {
public:
    explicit Batches(const CoverSearch& search)
        : search_(search), records_(search.tracer.records()),
          most_(std::min(search.mostChunks,
                         mostCoverChunks(search.patches.chunkCount(), search.device.info().software()))),
          commands_(search.device),
          targets_(search.device, {.size = uint64_t{most_} * kPlaces * kChunk * sizeof(glm::vec4),
                                   .memory = records_ ? vk::Memory::Device : vk::Memory::Host,
                                   .name = "places in texels"}),
          bits_(hostWords(uint64_t{most_} * kChunk, "seen places")),
          rays_(search.device, {.size = shader::kRayCounters * sizeof(uint32_t), .name = "rays"}),
          rate_(!search.device.info().software()) {
        if (!records_) return;
        ASSERT(search.devicePatches && search.deviceCovers);
        program_.emplace(search.device, "places");
        asks_ = hostWords(uint64_t{most_} * 2, "patches that ask");
        here_ = hostWords(uint64_t{most_} * kChunk, "places near by");
    }

    // Returns a bit for each of the places that these patches (ascending) see.
    std::vector<uint32_t> seen(std::span<const uint32_t> which, Places places) {
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
            ask(batch, {first, count}, places, &result[begin]);
            rate_.note(count, kCoverBatchMs, secondsSince(start));
            begin += batch.size();
        }
        return result;
    }

private:
    vk::Buffer hostWords(uint64_t count, const char* name) const {
        return {search_.device, {.size = count * sizeof(uint32_t), .memory = vk::Memory::Host, .name = name}};
    }

    // Writes the bits of what each of these patches sees.
    void ask(std::span<const uint32_t> which, ChunkRange range, Places places, uint32_t* seen) {
        const SegmentWork work{.firstChunk = range.first,
                               .chunkCount = range.count,
                               .targetCount = countOf(places),
                               .targets = &targets_,
                               .bits = &bits_,
                               .rays = &rays_};
        if (records_) {
            VkCommandBuffer cmd = commands_.begin();
            recordTargets(cmd, which, range, places);
            vk::barrier(cmd);
            search_.tracer.segments(cmd, work);
            vk::hostBarrier(cmd);
            commands_.run();
        } else {
            makeTargets(which, range, places, seen);
            search_.tracer.segments(VK_NULL_HANDLE, work);
        }
        const auto* const bits = bits_.as<uint32_t>();
        const auto* const here = records_ ? here_.as<uint32_t>() : nullptr;
        runPortions(workers(), which.size(), kLongPortion, [&](size_t begin, size_t end) {
            for (size_t i = begin; i < end; ++i) {
                const size_t at = which[i] - size_t{range.first} * kChunk;
                seen[i] = bits[at] | (here ? here[at] : seen[i]);
            }
        });
    }

    void recordTargets(VkCommandBuffer cmd, std::span<const uint32_t> which, ChunkRange range,
                       Places places) {
        auto* const asks = asks_.as<uint32_t>();
        std::fill_n(asks, size_t{range.count} * 2, 0u);
        for (const uint32_t patch : which) {
            const uint32_t at = patch - range.first * kChunk;
            asks[at / 32] |= 1u << at % 32;
        }
        const shader::PlacesPush push{.patches = search_.devicePatches->address(),
                                      .covers = search_.deviceCovers->address(),
                                      .asks = asks_.address(),
                                      .targets = targets_.address(),
                                      .here = here_.address(),
                                      .firstChunk = range.first,
                                      .places = countOf(places)};
        program_->dispatch(cmd, push, range.count);
    }

    // Does what shaders/surface/places.comp does, but leaves out cells that are not covered, of which nobody
    // reads the bits; the bits of places that need no segment go to `here`.
    void makeTargets(std::span<const uint32_t> which, ChunkRange range, Places places, uint32_t* here) {
        auto* const targets = targets_.as<glm::vec4>();
        const uint32_t count = countOf(places);
        const size_t perChunk = size_t{count} * kChunk;
        workers().run(range.count, [&](uint32_t chunk) {
            std::fill_n(targets + chunk * perChunk, perChunk, glm::vec4(0.0f));
        });
        constexpr size_t kPortion = 512; // patches that a thread looks at, at a time
        runPortions(workers(), which.size(), kPortion, [&](size_t begin, size_t end) {
            for (size_t i = begin; i < end; ++i) {
                const uint32_t patch = which[i];
                const size_t chunk = patch / kChunk - range.first;
                here[i] = 0;
                const uint32_t asked = places == Places::Rim ? ~0u : search_.patches.coverCells[patch];
                for (uint32_t k = 0; k < count; ++k) {
                    if ((asked >> k & 1u) == 0) continue;
                    const glm::vec4 target = shader::placeTarget(
                        search_.patches.scene.patches[patch], search_.patches.covers[patch],
                        places == Places::Rim ? shader::rimPlace(k) : shader::cellPlace(k));
                    targets[chunk * perChunk + size_t{k} * kChunk + patch % kChunk] = target;
                    if (target.w == 0.0f) here[i] |= 1u << k;
                }
            }
        });
    }

    WorkerPool& workers() const { return search_.device.workers(); }

    const CoverSearch& search_;
    bool records_; // segments are made and traced on the device
    uint32_t most_;
    vk::Commands commands_;
    std::optional<vk::ComputeProgram> program_;
    vk::Buffer targets_, bits_, rays_, asks_, here_;
    BatchRate rate_;
};

std::vector<uint32_t> coveredPatches(const PatchSet& patches, WorkerPool& pool) {
    return numbersWhere(pool, patches.coverCells.size(),
                        [&](size_t patch) { return patches.coverCells[patch] != 0; });
}

std::vector<uint32_t> patchesIn(std::span<const ChunkRange> chunks, std::span<const uint32_t> patches) {
    std::vector<uint32_t> in;
    for (const ChunkRange& range : chunks) {
        const auto first = std::lower_bound(patches.begin(), patches.end(), range.first * kChunk);
        const auto end = std::lower_bound(first, patches.end(), (range.first + range.count) * kChunk);
        in.insert(in.end(), first, end);
    }
    return in;
}

void shareCells(Ranks& ranks, const ChunkDeal& dealt, std::span<const uint32_t> which, PatchSet& patches,
                WorkerPool& pool) {
    if (ranks.alone()) return;
    std::vector<uint64_t> sizes;
    std::vector<uint32_t> byRank; // the patches, in the order in which their cells come
    for (uint32_t rank = 0; rank < ranks.count(); ++rank) {
        const std::vector<uint32_t> own = patchesIn(dealt.runsOf(rank), which);
        sizes.push_back(own.size() * sizeof(uint32_t));
        byRank.insert(byRank.end(), own.begin(), own.end());
    }
    const auto begin = std::accumulate(sizes.begin(), sizes.begin() + ranks.rank(), uint64_t{0});
    const auto mine =
        std::span(byRank).subspan(begin / sizeof(uint32_t), sizes[ranks.rank()] / sizeof(uint32_t));
    std::vector<uint32_t> own(mine.size()), cells(byRank.size());
    runPortions(pool, own.size(), kLongPortion, [&](size_t first, size_t end) {
        for (size_t i = first; i < end; ++i)
            own[i] = patches.covers[mine[i]].cells;
    });
    ranks.gather(std::as_bytes(std::span(own)), std::as_writable_bytes(std::span(cells)), sizes);
    runPortions(pool, cells.size(), kLongPortion, [&](size_t first, size_t end) {
        for (size_t i = first; i < end; ++i)
            patches.covers[byRank[i]].cells = cells[i];
    });
}

CoverSearcher::CoverSearcher(const CoverSearch& on) : on_(on) {}

CoverSearcher::~CoverSearcher() = default;

void CoverSearcher::release() {
    batches_.reset();
}

std::vector<uint32_t> CoverSearcher::search(std::span<const uint32_t> which) {
    if (which.empty()) return {};
    WorkerPool& pool = on_.device.workers();
    std::vector<shader::PatchCover>& covers = on_.patches.covers;
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
            cells = on_.patches.coverCells[which[i]];
            asks[i] = (cells & kCoverWhole) == 0;
        }
    });
    if (!batches_) batches_ = std::make_unique<Batches>(on_);
    // As a rule nothing stands in a texel whose whole rim is seen.
    const std::vector<uint32_t> whole = numbersWhere(pool, which.size(), [&](size_t i) { return !asks[i]; });
    const std::vector<uint32_t> rims = batches_->seen(patchesAt(whole), Places::Rim);
    runPortions(pool, whole.size(), kLongPortion, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i)
            asks[whole[i]] = std::popcount(rims[i] & ((1u << kRimPlaces) - 1)) < int{kRimPlaces};
    });
    const std::vector<uint32_t> parts =
        patchesAt(numbersWhere(pool, which.size(), [&](size_t i) { return asks[i]; }));
    const std::vector<uint32_t> cells = batches_->seen(parts, Places::Cells);
    runPortions(pool, parts.size(), kLongPortion, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i)
            covers[parts[i]].cells &= cells[i] & kCoverCells;
    });
    return patchesAt(
        numbersWhere(pool, which.size(), [&](size_t i) { return covers[which[i]].cells != before[i]; }));
}

uint64_t coverSearchBytes(uint32_t chunks, bool software) {
    return uint64_t{mostCoverChunks(chunks, software)} * kChunk *
               (kPlaces * sizeof(glm::vec4) + 2 * sizeof(uint32_t)) +
           mostCoverChunks(chunks, software) * sizeof(glm::uvec2) + shader::kRayCounters * sizeof(uint32_t);
}

} // namespace relume
