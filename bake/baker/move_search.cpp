#include "bake/baker/move_search.h"

#include <algorithm>

#include "bake/base/retrace_types.h"
#include "bake/validity/step_aside.h"

namespace relume {
namespace {

using shader::kChunk;

// This marks a link that was not traced again, where none are listed.
constexpr uint32_t kKept = 0xfffffff0u;
static_assert(kKept == shader::kLinkFirstSpecial && kKept < shader::kLinkDark);

constexpr uint32_t kPerChunk = kInsideDirections * kChunk; // links

// Returns the chunks of a batch. Batches are those of findInside(), but few rays of each are traced.
uint32_t batchOf(uint32_t chunkCount, bool software) {
    return std::min(software ? 64u : 1024u, chunkCount);
}

uint64_t wordsOf(uint32_t chunks) {
    return uint64_t{chunks} * kPerChunk;
}

// Returns the bytes of the list that come back with its batch: more is seldom listed, and read afterwards.
VkDeviceSize listedBytes(uint32_t chunks) {
    constexpr uint64_t kAtOnce = 16383; // with their number 64 KiB
    return (1 + std::min(kAtOnce, wordsOf(chunks))) * sizeof(uint32_t);
}

CoverSearch inBatches(CoverSearch search, uint32_t chunks) {
    search.mostChunks = chunks;
    return search;
}

} // namespace

MoveSearch::MoveSearch(const CoverSearch& on)
    : covers_(inBatches(on, batchOf(on.patches.chunkCount(), on.device.info().software()))),
      places_(on.device, on.tracer), batch_(covers_.on().mostChunks),
      links_(on.device, {.size = wordsOf(batch_) * sizeof(uint32_t),
                         .memory = vk::Memory::Host,
                         .name = "links from inside"}),
      list_(on.device, {.size = (1 + wordsOf(batch_)) * sizeof(uint32_t), .name = "links to trace"}),
      listed_(on.device,
              {.size = listedBytes(batch_), .memory = vk::Memory::Host, .name = "links that were traced"}),
      rays_(on.device, {.size = shader::kRayCounters * sizeof(uint32_t), .name = "rays"}),
      changed_(on.device, {.size = on.patches.chunkCount() * sizeof(glm::uvec2), .name = "changed patches"}),
      commands_(on.device) {}

uint64_t MoveSearch::bytes(uint32_t chunks, bool software) {
    const uint32_t batch = batchOf(chunks, software);
    const uint64_t list = (1 + wordsOf(batch)) * sizeof(uint32_t) + shader::kRayCounters * sizeof(uint32_t) +
                          chunks * sizeof(glm::uvec2);
    const uint64_t ofHost = wordsOf(batch) * sizeof(uint32_t) + listedBytes(batch);
    return list + (software ? ofHost : 0) + coverSearchBytes(batch, software) +
           placeSearchBytes(kMostCellsToTry * chunks, software);
}

void MoveSearch::put(const ObjectMove& move) {
    const VkDeviceSize bytes = move.boxes.size() * sizeof(shader::TraceBox);
    const VkDeviceSize room = std::max<VkDeviceSize>(bytes, sizeof(shader::TraceBox)); // panes have none
    if (!boxes_ || boxes_.size() < room) boxes_ = vk::Buffer(device(), {.size = room, .name = "boxes"});
    vk::upload(device(), boxes_, move.boxes.data(), bytes);
    vk::upload(device(), changed_, move.changed.data(), move.changed.size() * sizeof(glm::uvec2));
}

void MoveSearch::retrace(const ObjectMove& move,
                         const std::function<void(uint32_t patch, uint32_t direction, uint32_t link)>& hear) {
    put(move);
    Tracer& tracer = covers_.on().tracer;
    const uint32_t chunks = covers_.on().patches.chunkCount();
    const auto* links = links_.as<uint32_t>();
    const auto* listed = listed_.as<uint32_t>();
    for (uint32_t first = 0; first < chunks; first += batch_) {
        const uint32_t count = std::min(batch_, chunks - first);
        const auto tell = [&](uint32_t at) {
            hear((first + at / kPerChunk) * kChunk + at % kChunk, at / kChunk % kInsideDirections, links[at]);
        };
        if (tracer.onCpu()) std::fill_n(links_.as<uint32_t>(), uint64_t{count} * kPerChunk, kKept);
        VkCommandBuffer cmd = commands_.begin();
        tracer.retrace(cmd, {.closest = {.firstChunk = first,
                                         .chunkCount = count,
                                         .firstSample = 0,
                                         .sampleCount = kInsideDirections,
                                         .rotation = Rotation::Alone,
                                         .links = &links_},
                             .boxes = &boxes_,
                             .boxCount = static_cast<uint32_t>(move.boxes.size()),
                             .changed = &changed_,
                             .list = &list_,
                             .rays = &rays_,
                             .silent = true});
        if (!tracer.onCpu()) {
            const VkBufferCopy region{0, 0, listed_.size()};
            vkCmdCopyBuffer(cmd, list_.handle(), listed_.handle(), 1, &region);
        }
        vk::hostBarrier(cmd);
        commands_.run();
        if (tracer.onCpu()) {
            for (uint32_t at = 0; at < count * kPerChunk; ++at)
                if (links[at] != kKept) tell(at);
            continue;
        }
        const uint32_t found = listed[0], here = static_cast<uint32_t>(listed_.size() / sizeof(uint32_t)) - 1;
        std::for_each(listed + 1, listed + 1 + std::min(found, here), tell);
        if (found <= here) continue;
        const auto rest = vk::readBuffer<uint32_t>(device(), list_, found - here, 1 + here);
        std::for_each(rest.begin(), rest.end(), tell);
    }
}

} // namespace relume
