#include "bake/baker/inside_search.h"

#include <algorithm>

#include "assets/base/clock.h"
#include "assets/base/worker_pool.h"
#include "bake/base/batch_rate.h"
#include "bake/vk/commands.h"

namespace relume {
namespace {

using shader::kChunk;

// The aim of one submit [ms]; a wish to stop waits for as long.
constexpr double kInsideBatchMs = 20.0;
// A batch has at most so many chunks: on a GPU, which fewer would not fill, their links are 64 MiB. On a
// device that does a billion rays a second these are 16 ms.
constexpr uint32_t kMostInsideChunks = 8192, kMostInsideChunksOfSoftware = 1024;
// In closed rooms all of half the directions meet fronts, which settles it; outdoors three quarters are
// needed. Tracers that record take eight directions at a time.
constexpr uint32_t kFirstSamples = 16, kMoreSamples = 8;
// Chunks that are decided are asked on where so many at most lie between others that are not: a GPU takes
// longer for each range than for these. What they meet decides nothing else.
constexpr uint32_t kMostGap = 32;
constexpr uint32_t kChunksAtATime = 16; // that a thread looks through

uint32_t mostInsideChunks(uint32_t chunks, bool software) {
    return std::min(chunks, software ? kMostInsideChunksOfSoftware : kMostInsideChunks);
}

uint64_t batchBytes(uint32_t chunks, uint32_t samples) {
    return uint64_t{chunks} * samples * kChunk * sizeof(uint32_t);
}

/// The backs and sky that the directions of one patch have met so far.
struct Met {
    uint16_t backs = 0, sky = 0;
};

/// One batch of chunks.
class InsideBatch {
public:
    InsideBatch(const InsideSearch& search, uint32_t most)
        : search_(search), gap_(search.device.info().software() ? 0 : kMostGap), commands_(search.device),
          links_(search.device, {.size = batchBytes(most, search.samples),
                                 .memory = search.tracer.records() ? vk::Memory::Device : vk::Memory::Host,
                                 .name = "links"}) {
        // A GPU writes its own memory and sends it in one go faster than it writes each link to the host's.
        if (links_.mapped() == nullptr)
            back_ = vk::Buffer(
                search.device,
                {.size = links_.size(), .memory = vk::Memory::Host, .name = "links that come back"});
    }

    void run(uint32_t first, uint32_t count, std::vector<uint32_t>& inside) {
        first_ = first;
        met_.assign(size_t{count} * kChunk, Met{});
        if (search_.onLinks) {
            trace({{first, count}}, 0, search_.samples);
            const uint64_t links = uint64_t{count} * search_.samples * kChunk;
            search_.onLinks(first, {found(), links});
        } else {
            std::vector<ChunkRange> left = {{first, count}};
            for (uint32_t done = 0; done < search_.samples && !left.empty();) {
                const uint32_t wanted = done == 0 ? kFirstSamples : kMoreSamples;
                const uint32_t samples = std::min(wanted, search_.samples - done);
                trace(left, done, samples);
                done += samples;
                left = undecided(left, done);
            }
        }
        for (uint32_t i = 0; i < met_.size() && first * kChunk + i < search_.patches.count; ++i)
            if (liesInside(met_[i].backs, met_[i].sky, search_.samples)) inside.push_back(first * kChunk + i);
    }

private:
    void trace(const std::vector<ChunkRange>& ranges, uint32_t firstSample, uint32_t samples) {
        const bool records = search_.tracer.records();
        VkCommandBuffer cmd = records ? commands_.begin() : VK_NULL_HANDLE;
        uint64_t offset = 0;
        for (const ChunkRange& range : ranges) {
            search_.tracer.closest(cmd, {.firstChunk = range.first,
                                         .chunkCount = range.count,
                                         .firstSample = firstSample,
                                         .sampleCount = samples,
                                         .rotation = Rotation::Patch,
                                         .links = &links_,
                                         .linksOffset = offset});
            offset += uint64_t{range.count} * samples * kChunk;
        }
        if (records) {
            if (back_) {
                vk::barrier(cmd);
                const VkBufferCopy region{0, 0, offset * sizeof(uint32_t)};
                vkCmdCopyBuffer(cmd, links_.handle(), back_.handle(), 1, &region);
            }
            vk::hostBarrier(cmd);
            commands_.run();
        }
        const uint32_t* link = found();
        std::vector<uint32_t> traced; // chunks of the batch, in the order of their links
        for (const ChunkRange& range : ranges)
            for (uint32_t chunk = 0; chunk < range.count; ++chunk)
                traced.push_back(range.first - first_ + chunk);
        const auto count = static_cast<uint32_t>(traced.size());
        search_.device.workers().run((count + kChunksAtATime - 1) / kChunksAtATime, [&](uint32_t portion) {
            const uint32_t end = std::min(count, (portion + 1) * kChunksAtATime);
            for (uint32_t k = portion * kChunksAtATime; k < end; ++k)
                countMet(&met_[size_t{traced[k]} * kChunk], link + size_t{k} * samples * kChunk, samples);
        });
    }

    /// Returns the links of the last trace.
    const uint32_t* found() const {
        return static_cast<const uint32_t*>(back_ ? back_.mapped() : links_.mapped());
    }

    static void countMet(Met* met, const uint32_t* link, uint32_t samples) {
        for (uint32_t k = 0; k < samples; ++k)
            for (uint32_t i = 0; i < kChunk; ++i, ++link) {
                met[i].backs = static_cast<uint16_t>(met[i].backs + (*link == shader::kLinkBack));
                met[i].sky = static_cast<uint16_t>(met[i].sky + shader::linkIsSky(*link));
            }
    }

    /// Returns those of these chunks of which a patch could still turn out to lie inside something.
    std::vector<ChunkRange> undecided(const std::vector<ChunkRange>& ranges, uint32_t traced) const {
        std::vector<ChunkRange> left;
        const uint32_t rest = search_.samples - traced;
        for (const ChunkRange& range : ranges)
            for (uint32_t chunk = range.first; chunk < range.first + range.count; ++chunk) {
                const auto begin = met_.begin() + std::ptrdiff_t{chunk - first_} * kChunk;
                const bool open = std::any_of(begin, begin + kChunk, [&](const Met& met) {
                    return liesInside(met.backs + rest, met.sky, search_.samples);
                });
                if (!open) continue;
                if (!left.empty() && chunk - left.back().first - left.back().count <= gap_)
                    left.back().count = chunk + 1 - left.back().first;
                else
                    left.push_back({chunk, 1});
            }
        return left;
    }

    const InsideSearch& search_;
    const uint32_t gap_; // between ranges
    vk::Commands commands_;
    vk::Buffer links_, back_; // back_ where the host does not see links_
    uint32_t first_ = 0;
    std::vector<Met> met_; // of the batch
};

} // namespace

uint64_t insideBytes(uint32_t chunks, uint32_t samples, bool software) {
    return (software ? 1 : 2) * batchBytes(mostInsideChunks(chunks, software), samples);
}

std::vector<uint32_t> findInside(const InsideSearch& search) {
    const uint32_t most = mostInsideChunks(search.patches.chunkCount(), search.device.info().software());
    InsideBatch batch(search, most);
    BatchRate rate(!search.device.info().software());
    std::vector<uint32_t> inside;
    uint32_t all = 0, done = 0;
    for (const ChunkRange& range : search.chunks)
        all += range.count;
    for (const ChunkRange& range : search.chunks) {
        for (uint32_t at = 0; at < range.count;) {
            if (search.onBatch) search.onBatch(static_cast<double>(done) / all);
            const double wanted = std::clamp(rate.wanted(kInsideBatchMs), 1.0, static_cast<double>(most));
            const uint32_t count = std::min(static_cast<uint32_t>(wanted), range.count - at);
            const auto start = Clock::now();
            batch.run(range.first + at, count, inside);
            rate.note(count, kInsideBatchMs, secondsSince(start));
            at += count;
            done += count;
        }
    }
    return inside;
}

} // namespace relume
