#include "bake/layers/relinker.h"

#include "assets/base/clock.h"

#include <algorithm>
#include <utility>

namespace relume {

void Relinker::follow(const ObjectMove& move) {
    Relink relink{.rate = BatchRate(kit_.wide())};
    // Where an object moved on, links of early sample passes have followed the moves before, or some of them.
    ObjectMove early = move, late = move;
    if (relink_) {
        relink.earlySamplePasses = std::max(relink_->samplePass, relink_->earlySamplePasses);
        if (relink_->samplePass < relink_->earlySamplePasses) early.add(relink_->early.move);
        late.add(relink_->late.move);
    }
    const vk::Device& device = kit_.input.device;
    const auto path = [&](const ObjectMove& way) {
        Path made{way,
                  vk::makeBuffer(device, way.boxes, "boxes"),
                  vk::makeBuffer(device, way.changed, "changed patches"),
                  {}};
        if (!way.ends.empty()) made.ends = vk::makeBuffer(device, way.ends, "ends of links");
        return made;
    };
    if (relink.earlySamplePasses > 0) relink.early = path(early);
    relink.late = path(late);
    const uint64_t most = uint64_t{kit_.buffers.batchChunks} * kit_.linksOfSamplePass * shader::kChunk;
    if (!kit_.input.tracer.onCpu())
        relink.list = vk::Buffer(device, {.size = (most + 1) * sizeof(uint32_t), .name = "links to trace"});
    relink_ = std::move(relink);
}

void Relinker::batch() {
    Relink& relink = *relink_;
    const uint32_t chunks = kit_.chunkCount();
    if (relink.samplePass < links_.samplePasses()) {
        relink.chunk += retrace(relink, chunks - relink.chunk);
        if (relink.chunk < chunks) return;
        relink.chunk = 0;
        if (++relink.samplePass < links_.samplePasses()) return;
    }
    VkCommandBuffer cmd = kit_.commands.begin();
    kit_.recordRayCount(cmd);
    kit_.run(cmd);
    kit_.countRays();
    relink_.reset();
}

// Traces the links of the next chunks that are there. Returns how many chunks that settles.
uint32_t Relinker::retrace(Relink& relink, uint32_t most) {
    const LinkCache::Place place = links_.find(relink.samplePass, relink.chunk, most);
    if (!place.known) return place.count;
    const double wanted = std::max(1.0, relink.rate.wanted(kit_.batchMs));
    const auto count = static_cast<uint32_t>(
        std::min<double>({wanted, double(place.count), double(kit_.buffers.batchChunks)}));
    const auto start = Clock::now();
    const Path& path = relink.samplePass < relink.earlySamplePasses ? relink.early : relink.late;
    const RetraceWork work{.closest = {.firstChunk = relink.chunk,
                                       .chunkCount = count,
                                       .firstSample = relink.samplePass * kit_.linksOfSamplePass,
                                       .sampleCount = kit_.linksOfSamplePass,
                                       .rotation = kit_.settings.links.rotation,
                                       .links = place.links,
                                       .linksOffset = place.offset,
                                       .covers = kit_.covers()},
                           .boxes = &path.boxes,
                           .boxCount = static_cast<uint32_t>(path.move.boxes.size()),
                           .changed = &path.changed,
                           .ends = path.ends ? &path.ends : nullptr,
                           .list = &relink.list,
                           .rays = &kit_.buffers.rays};
    const bool records = kit_.input.tracer.records();
    VkCommandBuffer cmd = records ? kit_.commands.begin() : VK_NULL_HANDLE;
    kit_.input.tracer.retrace(cmd, work);
    if (records) kit_.run(cmd);
    relink.rate.note(count, kit_.batchMs, secondsSince(start));
    kit_.progress.traceSeconds += secondsSince(start);
    return count;
}

} // namespace relume
