#include "bake/gather/rank_chunks.h"

#include "assets/base/error.h"
#include "assets/base/portions.h"

#include <algorithm>
#include <cstring>
#include <numeric>

namespace relume {
namespace {

// Ranks share arrays in portions of so many bytes: that is little against what /dev/shm has in a container
// (64 MiB), and much against what a submit takes.
constexpr VkDeviceSize kPortionBytes = VkDeviceSize{16} << 20;
constexpr size_t kChunksAtATime = 1024; // of a thread that looks through all

std::vector<ChunkRange> rangesOfChunks(std::span<const uint32_t> chunks) {
    std::vector<ChunkRange> ranges;
    for (const uint32_t chunk : chunks) {
        if (!ranges.empty() && ranges.back().first + ranges.back().count == chunk)
            ++ranges.back().count;
        else
            ranges.push_back({chunk, 1});
    }
    return ranges;
}

using Regions = std::vector<VkBufferCopy>;

void recordCopy(VkCommandBuffer cmd, const vk::Buffer& from, const vk::Buffer& to, const Regions& regions) {
    if (!regions.empty())
        vkCmdCopyBuffer(cmd, from.handle(), to.handle(), static_cast<uint32_t>(regions.size()),
                        regions.data());
}

struct Portion {
    VkDeviceSize first = 0, bytes = 0;
};
// Returns what of these regions goes to a portion of the bytes, with its place in the stage, where the
// portion begins at `place`.
Regions portionOf(const Regions& regions, Portion portion, VkDeviceSize place) {
    Regions inside;
    for (const VkBufferCopy& region : regions) {
        const VkDeviceSize first = std::max(region.dstOffset, portion.first);
        const VkDeviceSize end = std::min(region.dstOffset + region.size, portion.first + portion.bytes);
        if (first < end)
            inside.push_back(
                {region.srcOffset + first - region.dstOffset, place + first - portion.first, end - first});
    }
    return inside;
}

// Returns regions that go the other way.
Regions reversed(Regions regions) {
    for (VkBufferCopy& region : regions)
        std::swap(region.srcOffset, region.dstOffset);
    return regions;
}

// The tiles of a lightmap, and which ranks have chunks in each.
class TileOwners {
public:
    TileOwners(WorkerPool& pool, const TraceScene& scene, const std::vector<uint32_t>& owners)
        : edge_((scene.size + kTileTexels - 1) / kTileTexels), tiles_(owners.size()),
          owners_(size_t{edge_} * edge_) {
        runPortions(pool, owners.size(), kChunksAtATime, [&](size_t begin, size_t end) {
            for (size_t chunk = begin; chunk < end; ++chunk)
                tiles_[chunk] = tilesOf(scene, static_cast<uint32_t>(chunk));
        });
        for (uint32_t chunk = 0; chunk < owners.size(); ++chunk)
            for (const uint32_t tile : tiles_[chunk])
                addOnce(owners_[tile], owners[chunk]);
    }

    /// Returns the ranks but its own that have a chunk in one of the tiles around those of this chunk.
    std::vector<uint32_t> ranksAround(uint32_t chunk, uint32_t own) const {
        std::vector<uint32_t> ranks;
        const auto edge = static_cast<int32_t>(edge_);
        for (const uint32_t tile : tiles_[chunk]) {
            const auto x = static_cast<int32_t>(tile % edge_), y = static_cast<int32_t>(tile / edge_);
            for (int32_t j = std::max(y - 1, 0); j <= std::min(y + 1, edge - 1); ++j)
                for (int32_t i = std::max(x - 1, 0); i <= std::min(x + 1, edge - 1); ++i)
                    for (const uint32_t rank :
                         owners_[static_cast<size_t>(j) * edge_ + static_cast<size_t>(i)])
                        if (rank != own) addOnce(ranks, rank);
        }
        return ranks;
    }

private:
    static void addOnce(std::vector<uint32_t>& list, uint32_t number) {
        if (std::find(list.begin(), list.end(), number) == list.end()) list.push_back(number);
    }

    // Padding lies in none of its chunk's own tiles, which harms nobody.
    std::vector<uint32_t> tilesOf(const TraceScene& scene, uint32_t chunk) const {
        std::vector<uint32_t> tiles;
        for (uint32_t lane = 0; lane < shader::kChunk; ++lane) {
            const uint32_t texel =
                shader::patchTexel(scene.patches[size_t{chunk} * shader::kChunk + lane].flags);
            const uint32_t x = texel % scene.size / kTileTexels, y = texel / scene.size / kTileTexels;
            if (y < edge_) addOnce(tiles, y * edge_ + x);
        }
        return tiles;
    }

    uint32_t edge_;                             // tiles along one
    std::vector<std::vector<uint32_t>> tiles_;  // in which a chunk has patches
    std::vector<std::vector<uint32_t>> owners_; // the ranks that have chunks in a tile
};

} // namespace

NearChunks nearChunks(WorkerPool& pool, const TraceScene& scene, const ChunkDeal& deal, uint32_t rank) {
    NearChunks near{.rows = std::vector<uint8_t>(deal.chunks(), 0),
                    .to = std::vector<std::vector<uint32_t>>(deal.ranks()),
                    .from = std::vector<std::vector<uint32_t>>(deal.ranks()),
                    .counts = std::vector<uint32_t>(size_t{deal.ranks()} * deal.ranks(), 0)};
    const std::vector<uint32_t> owners = deal.owners();
    const TileOwners tiles(pool, scene, owners);
    std::vector<std::vector<uint32_t>> around(deal.chunks()); // the other ranks around each chunk
    runPortions(pool, deal.chunks(), kChunksAtATime, [&](size_t begin, size_t end) {
        for (size_t chunk = begin; chunk < end; ++chunk)
            around[chunk] = tiles.ranksAround(static_cast<uint32_t>(chunk), owners[chunk]);
    });
    for (uint32_t chunk = 0; chunk < deal.chunks(); ++chunk) {
        const uint32_t owner = owners[chunk];
        if (owner == rank) near.rows[chunk] = 1;
        for (const uint32_t other : around[chunk]) {
            ++near.counts[size_t{owner} * deal.ranks() + other];
            if (owner == rank) near.to[other].push_back(chunk);
            if (other != rank) continue;
            near.from[owner].push_back(chunk);
            near.rows[chunk] = 1;
        }
    }
    return near;
}

RankChunks::RankChunks(const vk::Device& device, Ranks& ranks, const PatchSet& patches)
    : device_(device), ranks_(ranks),
      deal_(patches.chunkCount(), ranks.count(), ChunkDeal::runsFor(device.info().software())),
      commands_(device), stage_(device, ranks) {
    if (alone()) {
        rows_ = {{0, patches.chunkCount()}};
        return;
    }
    near_ = nearChunks(device.workers(), patches.scene, deal_, ranks.rank());
    rows_ = rangesOf(near_.rows, true);
    stage_.reserve(
        std::min(deal_.chunks() * VkDeviceSize{shader::kChunk} * sizeof(glm::uvec2), kPortionBytes));
}

std::vector<uint8_t> RankChunks::ownOf(std::vector<uint8_t> marks) const {
    ASSERT(marks.size() == deal_.chunks());
    if (alone()) return marks;
    std::vector<uint8_t> own(marks.size(), 0);
    for (const ChunkRange& run : this->own())
        std::copy_n(marks.begin() + run.first, run.count, own.begin() + run.first);
    return own;
}

void RankChunks::reserve(vk::Buffer& staging, VkDeviceSize bytes) const {
    if (bytes == 0 || (staging && staging.size() >= bytes)) return;
    const vk::MemoryOwner owner("ranks");
    staging = {}; // before the larger one takes its memory
    staging = vk::Buffer(device_, {.size = bytes, .memory = vk::Memory::Host, .name = "chunks of ranks"});
}

void RankChunks::run(const std::function<void(VkCommandBuffer)>& record) {
    VkCommandBuffer cmd = commands_.begin();
    vk::barrier(cmd);
    record(cmd);
    vk::barrier(cmd);
    vk::hostBarrier(cmd);
    commands_.run();
}

void RankChunks::copy(const vk::Buffer& from, const vk::Buffer& to, const Regions& regions) {
    if (!regions.empty()) run([&](VkCommandBuffer cmd) { recordCopy(cmd, from, to, regions); });
}

// Appends regions that pack these chunks of one array at a place of the host's memory, from the buffer.
// Returns the place behind them.
VkDeviceSize RankChunks::appendRanges(Regions& regions, std::span<const ChunkRange> ranges,
                                      VkDeviceSize chunkBytes, VkDeviceSize arrayStart, VkDeviceSize at) {
    for (const ChunkRange& range : ranges) {
        regions.push_back({arrayStart + range.first * chunkBytes, at, range.count * chunkBytes});
        at += range.count * chunkBytes;
    }
    return at;
}

void RankChunks::share(const Shared& shared) {
    if (alone()) return;
    const VkDeviceSize arrayBytes = shared.buffer.size() / shared.arrays;
    for (uint32_t array = 0; array < shared.arrays; ++array)
        if (!shareByStage(shared, array * arrayBytes)) shareByMessages(shared, array * arrayBytes);
}

// Bytes go in portions. While what others have of one is taken in, what this rank has of the next one goes
// out.
bool RankChunks::goByStage(const vk::Buffer& buffer, VkDeviceSize bytes, const Ways& ways) {
    const VkDeviceSize portion = std::min(bytes, kPortionBytes);
    std::optional<VkDeviceSize> half = stage_.turn(portion);
    if (!half) return false;
    copy(buffer, stage_.buffer(), portionOf(ways.out, {0, portion}, *half));
    for (VkDeviceSize at = 0; at < bytes; at += portion) {
        ranks_.meet();
        const Regions in = reversed(portionOf(ways.in, {at, portion}, *half));
        Regions out;
        if (at + portion < bytes) {
            half = stage_.turn(portion);
            out = portionOf(ways.out, {at + portion, portion}, *half);
        }
        run([&](VkCommandBuffer cmd) {
            recordCopy(cmd, stage_.buffer(), buffer, in);
            recordCopy(cmd, buffer, stage_.buffer(), out);
        });
    }
    return true;
}

// Chunks stand where they stand in the array.
bool RankChunks::shareByStage(const Shared& shared, VkDeviceSize arrayStart) {
    Ways ways;
    for (uint32_t rank = 0; rank < ranks_.count(); ++rank)
        for (const ChunkRange& run : deal_.runsOf(rank))
            (rank == ranks_.rank() ? ways.out : ways.in)
                .push_back({arrayStart + run.first * shared.chunkBytes, run.first * shared.chunkBytes,
                            run.count * shared.chunkBytes});
    return goByStage(shared.buffer, deal_.chunks() * shared.chunkBytes, ways);
}

// Gathers an array in host memory, in the ranks' order.
void RankChunks::shareByMessages(const Shared& shared, VkDeviceSize arrayStart) {
    Regions out, in;
    std::vector<uint64_t> sizes;
    VkDeviceSize at = 0;
    for (uint32_t rank = 0; rank < ranks_.count(); ++rank) {
        const bool own = rank == ranks_.rank();
        const VkDeviceSize end =
            appendRanges(own ? out : in, deal_.runsOf(rank), shared.chunkBytes, arrayStart, own ? 0 : at);
        sizes.push_back(deal_.chunksOf(rank) * shared.chunkBytes);
        at = own ? at + end : end;
    }
    const VkDeviceSize ownBytes = sizes[ranks_.rank()];
    reserve(sent_, ownBytes);
    reserve(received_, at);
    copy(shared.buffer, sent_, out);
    ranks_.gather({ownBytes > 0 ? sent_.as<std::byte>() : nullptr, ownBytes}, {received_.as<std::byte>(), at},
                  sizes);
    copy(received_, shared.buffer, reversed(in));
}

// Brings an array in host memory, whose parts stand in the stage where they stand in the array.
void RankChunks::shareHost(std::span<std::byte> array, uint64_t chunkBytes) {
    const std::optional<VkDeviceSize> half = stage_.turn(array.size());
    if (!half) return shareChunks(ranks_, deal_, array, chunkBytes);
    std::byte* stage = stage_.buffer().as<std::byte>() + *half;
    const auto copyRuns = [&](uint32_t rank, std::byte* to, const std::byte* from) {
        for (const ChunkRange& run : deal_.runsOf(rank))
            std::memcpy(to + run.first * chunkBytes, from + run.first * chunkBytes, run.count * chunkBytes);
    };
    copyRuns(ranks_.rank(), stage, array.data());
    ranks_.meet();
    for (uint32_t rank = 0; rank < ranks_.count(); ++rank)
        if (rank != ranks_.rank()) copyRuns(rank, array.data(), stage);
}

// Messages stand in the stage by sender, and of each by receiver: every rank knows where.
bool RankChunks::shareNearByStage(const Shared& shared) {
    const VkDeviceSize bytes = shared.chunkBytes * shared.arrays;
    const VkDeviceSize all = std::accumulate(near_.counts.begin(), near_.counts.end(), VkDeviceSize{0});
    if (all == 0) return true;
    const VkDeviceSize arrayBytes = shared.buffer.size() / shared.arrays;
    Ways ways;
    VkDeviceSize at = 0;
    for (uint32_t from = 0; from < ranks_.count(); ++from)
        for (uint32_t to = 0; to < ranks_.count(); ++to) {
            VkDeviceSize place = at;
            for (uint32_t array = 0; array < shared.arrays; ++array) {
                if (from == ranks_.rank())
                    place = appendRanges(ways.out, rangesOfChunks(near_.to[to]), shared.chunkBytes,
                                         array * arrayBytes, place);
                else if (to == ranks_.rank())
                    place = appendRanges(ways.in, rangesOfChunks(near_.from[from]), shared.chunkBytes,
                                         array * arrayBytes, place);
            }
            at += near_.counts[size_t{from} * ranks_.count() + to] * bytes;
        }
    return goByStage(shared.buffer, all * bytes, ways);
}

void RankChunks::shareNear(const Shared& shared) {
    if (alone() || shareNearByStage(shared)) return;
    const VkDeviceSize arrayBytes = shared.buffer.size() / shared.arrays;
    // Lays out the chunks of all messages, rank by rank and array by array.
    const auto layOut = [&](const std::vector<std::vector<uint32_t>>& lists, Regions& regions) {
        std::vector<VkDeviceSize> ends;
        VkDeviceSize at = 0;
        for (const std::vector<uint32_t>& chunks : lists) {
            const std::vector<ChunkRange> ranges = rangesOfChunks(chunks);
            for (uint32_t array = 0; array < shared.arrays; ++array)
                at = appendRanges(regions, ranges, shared.chunkBytes, array * arrayBytes, at);
            ends.push_back(at);
        }
        return ends;
    };
    Regions out, in;
    const std::vector<VkDeviceSize> sentEnds = layOut(near_.to, out), receivedEnds = layOut(near_.from, in);
    reserve(sent_, sentEnds.back());
    reserve(received_, receivedEnds.back());
    copy(shared.buffer, sent_, out);
    std::vector<Ranks::Sent> sent;
    std::vector<Ranks::Received> received;
    VkDeviceSize sentAt = 0, receivedAt = 0;
    for (uint32_t rank = 0; rank < ranks_.count(); ++rank) {
        if (sentEnds[rank] > sentAt)
            sent.push_back({rank, {sent_.as<std::byte>() + sentAt, sentEnds[rank] - sentAt}});
        if (receivedEnds[rank] > receivedAt)
            received.push_back(
                {rank, {received_.as<std::byte>() + receivedAt, receivedEnds[rank] - receivedAt}});
        sentAt = sentEnds[rank];
        receivedAt = receivedEnds[rank];
    }
    ranks_.exchange(sent, received);
    copy(received_, shared.buffer, reversed(in));
}

} // namespace relume
