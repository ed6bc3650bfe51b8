#include "bake/validity/inside_search.h"

#include <algorithm>
#include <cstring>
#include <numeric>

#include "assets/base/clock.h"
#include "assets/base/portions.h"
#include "bake/base/batch_rate.h"
#include "bake/vk/commands.h"

namespace relume {
namespace {

using shader::kChunk;

// The aim of one submit [ms]; a wish to stop waits for as long.
constexpr double kInsideBatchMs = 20.0;
// A batch has at most so many chunks: on a GPU, which fewer would not fill, the links of one step are 16 MiB.
constexpr uint32_t kMostInsideChunks = 8192, kMostInsideChunksOfSoftware = 1024;
// Likewise of places that stand in for patches. What they take is less than what a search for covers does.
constexpr uint32_t kMostChunksOfPlaces = 1024;
// So many directions are followed in a step: tracers that record take eight at a time.
constexpr uint32_t kStep = kFirstDirections;
static_assert(kInsideDirections % kStep == 0);
// On a GPU, chunks that are decided are asked on where so many at most lie between others that are not: it
// takes longer for each range than for these. What they meet decides nothing else.
constexpr uint32_t kMostGap = 32;
constexpr uint32_t kChunksAtATime = 16; // that a thread looks through

uint32_t mostInsideChunks(uint32_t chunks, bool software) {
    return std::min(chunks, software ? kMostInsideChunksOfSoftware : kMostInsideChunks);
}

uint32_t chunksFor(size_t patches) {
    return static_cast<uint32_t>((patches + kChunk - 1) / kChunk);
}

uint64_t stepBytes(uint32_t chunks) {
    return uint64_t{chunks} * kStep * kChunk * sizeof(uint32_t);
}

/// Follows directions, at most so many chunks of patches at a time. A CPU follows those of single patches, a
/// GPU those of whole chunks.
class DirectionSteps {
public:
    DirectionSteps(const vk::Device& device, Tracer& tracer, uint32_t most)
        : device_(device), tracer_(tracer), most_(most), commands_(device),
          links_(device, {.size = stepBytes(most),
                          .memory = tracer.records() ? vk::Memory::Device : vk::Memory::Host,
                          .name = "links"}) {
        // A GPU writes its own memory and sends it in one go faster than it writes each link to the host's.
        if (links_.mapped() == nullptr)
            back_ = vk::Buffer(
                device, {.size = links_.size(), .memory = vk::Memory::Host, .name = "links that come back"});
    }

    uint32_t most() const { return most_; }

    /// Follows a step's directions of chunks of the scene, or of patches that stand in for its. hear(chunk,
    /// links[kStep][64]) hears of each, counted from the first one.
    template<typename Hear>
    void follow(const std::vector<ChunkRange>& ranges, uint32_t firstDirection, const Hear& hear,
                const shader::Patch* receivers = nullptr, const vk::Buffer* onDevice = nullptr) {
        VkCommandBuffer cmd = tracer_.records() ? commands_.begin() : VK_NULL_HANDLE;
        uint32_t count = 0;
        for (const ChunkRange& range : ranges) {
            tracer_.closest(cmd, {.receivers = onDevice,
                                  .receiversHost = receivers,
                                  .firstChunk = range.first,
                                  .chunkCount = range.count,
                                  .firstSample = firstDirection,
                                  .sampleCount = kStep,
                                  .rotation = Rotation::Alone,
                                  .links = &links_,
                                  .linksOffset = uint64_t{count} * kStep * kChunk});
            count += range.count;
        }
        if (tracer_.records()) {
            if (back_) {
                vk::barrier(cmd);
                const VkBufferCopy region{0, 0, stepBytes(count)};
                vkCmdCopyBuffer(cmd, links_.handle(), back_.handle(), 1, &region);
            }
            vk::hostBarrier(cmd);
            commands_.run();
        }
        const auto* links = static_cast<const uint32_t*>(back_ ? back_.mapped() : links_.mapped());
        device_.workers().run((count + kChunksAtATime - 1) / kChunksAtATime, [&](uint32_t portion) {
            const uint32_t end = std::min(count, (portion + 1) * kChunksAtATime);
            for (uint32_t k = portion * kChunksAtATime; k < end; ++k)
                hear(k, links + size_t{k} * kStep * kChunk);
        });
    }

    /// Follows a step's directions of these patches, whose bits are met[patch - first].
    void followPatches(const PatchSet& patches, std::span<const uint32_t> which, uint32_t firstDirection,
                       MetBits* met, uint32_t first) {
        std::vector<shader::Patch> receivers;
        for (const uint32_t patch : which)
            receivers.push_back(patches.scene.patches[patch]);
        followPlaces(std::move(receivers), firstDirection,
                     [&](size_t i) -> MetBits& { return met[which[i] - first]; });
    }

    /// Follows a step's directions of places that stand in for patches; metOf(number) returns the bits of a
    /// place.
    template<typename MetOf>
    void followPlaces(std::vector<shader::Patch> receivers, uint32_t firstDirection, const MetOf& metOf) {
        const size_t count = receivers.size();
        const uint32_t chunks = chunksFor(count);
        for (shader::Patch& receiver : receivers)
            receiver.flags |= shader::kPatchSends; // no ray leaves a patch that was found to lie inside
        receivers.resize(size_t{chunks} * kChunk);
        if (tracer_.records()) {
            const VkDeviceSize bytes = receivers.size() * sizeof(shader::Patch);
            if (!receivers_ || receivers_.size() < bytes)
                receivers_ = vk::Buffer(
                    device_, {.size = bytes, .memory = vk::Memory::Host, .name = "patches that are asked"});
            std::memcpy(receivers_.mapped(), receivers.data(), bytes);
        }
        const auto hear = [&](uint32_t chunk, const uint32_t* links) {
            const size_t begin = size_t{chunk} * kChunk, end = std::min(count, begin + kChunk);
            for (size_t i = begin; i < end; ++i)
                for (uint32_t k = 0; k < kStep; ++k)
                    metOf(i).note(firstDirection + k, links[size_t{k} * kChunk + i - begin]);
        };
        follow({{0, chunks}}, firstDirection, hear, receivers.data(), receivers_ ? &receivers_ : nullptr);
    }

private:
    const vk::Device& device_;
    Tracer& tracer_;
    uint32_t most_; // chunks
    vk::Commands commands_;
    vk::Buffer links_, back_; // back_ where the host does not see links_
    vk::Buffer receivers_;    // places that stand in for patches, for a tracer that records
};

/// One batch of chunks.
class InsideBatch {
public:
    InsideBatch(const InsideSearch& search, uint32_t most)
        : search_(search), steps_(search.device, search.tracer, most) {}

    void run(uint32_t first, uint32_t count, std::vector<uint32_t>& inside) {
        first_ = first;
        met_.resize(size_t{count} * kChunk);
        runPortions(workers(), met_.size(), kPatchesAtATime,
                    [&](size_t begin, size_t end) { std::fill_n(&met_[begin], end - begin, MetBits{}); });
        followChunks({{first, count}}, 0);
        if (search_.tracer.records()) {
            std::vector<ChunkRange> left = {{first, count}};
            for (uint32_t done = kStep; done < kInsideDirections; done += kStep) {
                left = undecided(left);
                if (left.empty()) break;
                followChunks(left, done);
            }
        } else {
            std::vector<uint32_t> left = patchesWhere([&](uint32_t patch) { return isOpen(patch); });
            for (uint32_t done = kStep; done < kInsideDirections && !left.empty(); done += kStep) {
                steps_.followPatches(search_.patches, left, done, met_.data(), first * kChunk);
                std::erase_if(left, [&](uint32_t patch) { return !isOpen(patch); });
            }
        }
        const std::vector<uint32_t> found = patchesWhere(
            [&](uint32_t patch) { return isPatch(patch) && insideBy(metBy(patch)) == Inside::Yes; });
        inside.insert(inside.end(), found.begin(), found.end());
        if (search_.touching) {
            const std::vector<uint32_t> touching =
                patchesWhere([&](uint32_t patch) { return isPatch(patch) && mayTouch(metBy(patch)); });
            search_.touching->insert(search_.touching->end(), touching.begin(), touching.end());
        }
        if (search_.met) std::copy(met_.begin(), met_.end(), search_.met->begin() + first * kChunk);
    }

private:
    // A thread takes so many at a time.
    static constexpr size_t kPatchesAtATime = size_t{1} << 16;

    WorkerPool& workers() const { return search_.device.workers(); }
    const MetBits& metBy(uint32_t patch) const { return met_[patch - first_ * kChunk]; }
    // Returns the batch's patches that `takes` is true of, ascending.
    template<typename Takes>
    std::vector<uint32_t> patchesWhere(const Takes& takes) const {
        const auto begin = first_ * kChunk;
        std::vector<uint32_t> found = numbersWhere(
            workers(), met_.size(), [&](size_t i) { return takes(begin + static_cast<uint32_t>(i)); });
        for (uint32_t& patch : found)
            patch += begin;
        return found;
    }

    bool isPatch(uint32_t patch) const { return patch < search_.patches.count; }
    bool isOpen(uint32_t patch) const { return isPatch(patch) && insideBy(metBy(patch)) == Inside::Unknown; }

    static std::vector<uint32_t> chunksOf(const std::vector<ChunkRange>& ranges) {
        std::vector<uint32_t> chunks;
        for (const ChunkRange& range : ranges)
            for (uint32_t chunk = range.first; chunk < range.first + range.count; ++chunk)
                chunks.push_back(chunk);
        return chunks;
    }

    void followChunks(const std::vector<ChunkRange>& ranges, uint32_t firstDirection) {
        const std::vector<uint32_t> chunks = chunksOf(ranges); // in the order of their links
        steps_.follow(ranges, firstDirection, [&](uint32_t k, const uint32_t* links) {
            MetBits* met = &met_[size_t{chunks[k] - first_} * kChunk];
            for (uint32_t step = 0; step < kStep; ++step)
                for (uint32_t i = 0; i < kChunk; ++i)
                    met[i].note(firstDirection + step, links[step * kChunk + i]);
        });
    }

    /// Returns those of these chunks that have patches of which it is not known whether they lie inside
    /// something.
    std::vector<ChunkRange> undecided(const std::vector<ChunkRange>& ranges) const {
        const std::vector<uint32_t> chunks = chunksOf(ranges);
        const std::vector<uint32_t> open = numbersWhere(workers(), chunks.size(), [&](size_t k) {
            const uint32_t begin = chunks[k] * kChunk;
            for (uint32_t patch = begin; patch < begin + kChunk; ++patch)
                if (isOpen(patch)) return true;
            return false;
        });
        std::vector<ChunkRange> left;
        for (const uint32_t k : open) {
            const uint32_t chunk = chunks[k];
            if (!left.empty() && chunk - left.back().first - left.back().count <= kMostGap)
                left.back().count = chunk + 1 - left.back().first;
            else
                left.push_back({chunk, 1});
        }
        return left;
    }

    const InsideSearch& search_;
    DirectionSteps steps_;
    uint32_t first_ = 0;
    std::vector<MetBits> met_; // of the batch
};

} // namespace

uint64_t insideBytes(uint32_t chunks, bool software) {
    return (software ? 1 : 2) * stepBytes(mostInsideChunks(chunks, software));
}

std::vector<uint32_t> findInside(const InsideSearch& search) {
    const uint32_t most = mostInsideChunks(search.patches.chunkCount(), search.device.info().software());
    InsideBatch batch(search, most);
    BatchRate rate(!search.device.info().software());
    if (search.met) search.met->assign(size_t{search.patches.chunkCount()} * kChunk, MetBits{});
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

void followAll(const vk::Device& device, Tracer& tracer, const PatchSet& patches,
               std::span<const uint32_t> which, std::vector<MetBits>& met) {
    if (which.empty()) return;
    const uint32_t most = mostInsideChunks(chunksFor(which.size()), device.info().software());
    DirectionSteps steps(device, tracer, most);
    for (size_t at = 0; at < which.size(); at += size_t{most} * kChunk)
        for (uint32_t direction = 0; direction < kInsideDirections; direction += kStep)
            steps.followPatches(patches,
                                which.subspan(at, std::min(which.size() - at, size_t{most} * kChunk)),
                                direction, met.data(), 0);
}

class PlaceSearcher::Steps : public DirectionSteps {
public:
    using DirectionSteps::DirectionSteps;
};

PlaceSearcher::PlaceSearcher(const vk::Device& device, Tracer& tracer) : device_(device), tracer_(tracer) {}

PlaceSearcher::~PlaceSearcher() = default;

std::vector<PlaceKind> PlaceSearcher::kindsOf(std::span<const shader::Patch> places,
                                              const std::function<void(double done)>& onBatch) {
    std::vector<MetBits> met(places.size());
    std::vector<uint32_t> open(places.size());
    std::iota(open.begin(), open.end(), 0u);
    const uint32_t most = std::min(chunksFor(places.size()), kMostChunksOfPlaces);
    if (!steps_ || steps_->most() < most) {
        steps_.reset(); // first: not both at once
        steps_ = std::make_unique<Steps>(device_, tracer_, most);
    }
    for (uint32_t direction = 0; direction < kInsideDirections && !open.empty(); direction += kStep) {
        for (size_t at = 0; at < open.size(); at += size_t{most} * kChunk) {
            if (onBatch) onBatch(static_cast<double>(direction) / kInsideDirections);
            const auto some = std::span(open).subspan(at, std::min(open.size() - at, size_t{most} * kChunk));
            std::vector<shader::Patch> receivers;
            for (const uint32_t place : some)
                receivers.push_back(places[place]);
            steps_->followPlaces(std::move(receivers), direction,
                                 [&](size_t i) -> MetBits& { return met[some[i]]; });
        }
        std::erase_if(open, [&](uint32_t place) { return insideBy(met[place]) != Inside::Unknown; });
    }
    std::vector<PlaceKind> kinds;
    for (const MetBits& bits : met)
        kinds.push_back(insideBy(bits) == Inside::Yes ? PlaceKind::Inside
                        : mayTouch(bits)              ? PlaceKind::Touching
                                                      : PlaceKind::Outside);
    return kinds;
}

uint64_t placeSearchBytes(uint32_t chunks, bool software) {
    const uint32_t most = std::min(chunks, kMostChunksOfPlaces);
    const uint64_t ofHost = stepBytes(most) + uint64_t{most} * kChunk * sizeof(shader::Patch);
    return stepBytes(most) + (software ? ofHost : 0);
}

} // namespace relume
