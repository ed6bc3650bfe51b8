#include "bake/gather/rank_chunks.h"

#include "assets/base/error.h"

#include <algorithm>

namespace relume {
namespace {

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

// The tiles of a lightmap, and which ranks have chunks in each.
class TileOwners {
public:
    TileOwners(const TraceScene& scene, const std::vector<uint32_t>& owners)
        : scene_(scene), edge_((scene.size + kTileTexels - 1) / kTileTexels), owners_(size_t{edge_} * edge_) {
        for (uint32_t chunk = 0; chunk < owners.size(); ++chunk)
            for (const uint32_t tile : tilesOf(chunk)) {
                std::vector<uint32_t>& list = owners_[tile];
                if (std::find(list.begin(), list.end(), owners[chunk]) == list.end())
                    list.push_back(owners[chunk]);
            }
    }

    /// Returns the tiles in which a chunk has patches; padding lies in none of its own, which harms nobody.
    std::vector<uint32_t> tilesOf(uint32_t chunk) const {
        std::vector<uint32_t> tiles;
        for (uint32_t lane = 0; lane < shader::kChunk; ++lane) {
            const uint32_t texel =
                shader::patchTexel(scene_.patches[size_t{chunk} * shader::kChunk + lane].flags);
            const uint32_t x = texel % scene_.size / kTileTexels, y = texel / scene_.size / kTileTexels;
            const uint32_t tile = y * edge_ + x;
            if (y < edge_ && (tiles.empty() || std::find(tiles.begin(), tiles.end(), tile) == tiles.end()))
                tiles.push_back(tile);
        }
        return tiles;
    }

    /// Returns the ranks that have a chunk in one of the tiles around those of this chunk.
    std::vector<uint32_t> ranksAround(uint32_t chunk) const {
        std::vector<uint32_t> ranks;
        const auto edge = static_cast<int32_t>(edge_);
        for (const uint32_t tile : tilesOf(chunk)) {
            const auto x = static_cast<int32_t>(tile % edge_), y = static_cast<int32_t>(tile / edge_);
            for (int32_t j = std::max(y - 1, 0); j <= std::min(y + 1, edge - 1); ++j)
                for (int32_t i = std::max(x - 1, 0); i <= std::min(x + 1, edge - 1); ++i)
                    for (const uint32_t rank :
                         owners_[static_cast<size_t>(j) * edge_ + static_cast<size_t>(i)])
                        if (std::find(ranks.begin(), ranks.end(), rank) == ranks.end()) ranks.push_back(rank);
        }
        return ranks;
    }

private:
    const TraceScene& scene_;
    uint32_t edge_; // tiles along one
    std::vector<std::vector<uint32_t>> owners_;
};

} // namespace

NearChunks nearChunks(const TraceScene& scene, const ChunkDeal& deal, uint32_t rank) {
    NearChunks near{.rows = std::vector<uint8_t>(deal.chunks(), 0),
                    .to = std::vector<std::vector<uint32_t>>(deal.ranks()),
                    .from = std::vector<std::vector<uint32_t>>(deal.ranks())};
    const std::vector<uint32_t> owners = deal.owners();
    const TileOwners tiles(scene, owners);
    for (uint32_t chunk = 0; chunk < deal.chunks(); ++chunk) {
        const uint32_t owner = owners[chunk];
        if (owner == rank) near.rows[chunk] = 1;
        for (const uint32_t other : tiles.ranksAround(chunk)) {
            if (other == owner) continue;
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
      deal_(patches.chunkCount(), ranks.count(), ChunkDeal::leastRunOf(device.info().software())),
      commands_(device) {
    if (alone()) {
        rows_ = {{0, patches.chunkCount()}};
        return;
    }
    near_ = nearChunks(patches.scene, deal_, ranks.rank());
    rows_ = rangesOf(near_.rows, true);
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

void RankChunks::copy(const vk::Buffer& from, const vk::Buffer& to, const Regions& regions) {
    if (regions.empty()) return;
    VkCommandBuffer cmd = commands_.begin();
    vk::barrier(cmd);
    vkCmdCopyBuffer(cmd, from.handle(), to.handle(), static_cast<uint32_t>(regions.size()), regions.data());
    vk::barrier(cmd);
    vk::hostBarrier(cmd);
    commands_.run();
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
    const VkDeviceSize all = deal_.chunks() * shared.chunkBytes;
    std::vector<uint64_t> sizes;
    for (uint32_t rank = 0; rank < ranks_.count(); ++rank)
        sizes.push_back(deal_.chunksOf(rank) * shared.chunkBytes);
    const uint64_t ownBytes = sizes[ranks_.rank()];
    reserve(sent_, ownBytes);
    reserve(received_, all);
    const VkDeviceSize arrayBytes = shared.buffer.size() / shared.arrays;
    for (uint32_t array = 0; array < shared.arrays; ++array) {
        Regions out, in;
        appendRanges(out, own(), shared.chunkBytes, array * arrayBytes, 0);
        copy(shared.buffer, sent_, out);
        ranks_.gather({ownBytes > 0 ? sent_.as<std::byte>() : nullptr, ownBytes},
                      {received_.as<std::byte>(), all}, sizes);
        VkDeviceSize at = 0;
        for (uint32_t rank = 0; rank < ranks_.count(); ++rank) {
            if (rank == ranks_.rank())
                at += ownBytes;
            else
                at = appendRanges(in, deal_.runsOf(rank), shared.chunkBytes, array * arrayBytes, at);
        }
        for (VkBufferCopy& region : in)
            std::swap(region.srcOffset, region.dstOffset);
        copy(received_, shared.buffer, in);
    }
}

void RankChunks::shareNear(const Shared& shared) {
    if (alone()) return;
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
    for (VkBufferCopy& region : in)
        std::swap(region.srcOffset, region.dstOffset);
    copy(received_, shared.buffer, in);
}

} // namespace relume
