#include "bake/trace/embree_tracer.h"
#include "assets/base/error.h"
#include "bake/trace/embree_scene.h"
#include "bake/trace/tracer.h"

namespace relume {

namespace {

template<typename T>
T* mappedAs(const vk::Buffer* buffer, uint64_t count) {
    ASSERT(buffer && buffer->mapped() && buffer->size() >= count * sizeof(T));
    return static_cast<T*>(buffer->mapped());
}

class EmbreeTracer : public Tracer {
public:
    EmbreeTracer(const TraceScene& scene, WorkerPool& pool)
        : chunkCount_(scene.chunkCount()), scene_(scene, pool) {}
    const char* name() const override { return "embree"; }
    bool onCpu() const override { return true; }

    void occlusion(VkCommandBuffer, const OcclusionWork& work) override {
        const SenderRuns list = work.senders ? *work.senders : SenderRuns{};
        const uint64_t columns = work.senders ? list.senders.size() / shader::kChunk : chunkCount_;
        const uint64_t counters = uint64_t{2} * shader::kRayCounters;
        scene_.occlusion({.supers = work.supers,
                          .bits = work.bits,
                          .firstUnit = work.firstUnit,
                          .unitCount = work.unitCount,
                          .sends = mappedAs<uint32_t>(work.sends, columns),
                          .senders = list.senders,
                          .members = list.members,
                          .reversed = work.reversed,
                          .rays = work.rays ? mappedAs<uint32_t>(work.rays, counters) : nullptr});
    }

    void closest(VkCommandBuffer, const ClosestWork& work) override { scene_.closest(arrays(work)); }

    bool follows() const override { return true; }
    void update(const SceneChange&) override { scene_.update(); }
    void retrace(VkCommandBuffer, const RetraceWork& work) override {
        ASSERT(!work.closest.receiversHost && !work.closest.disc);
        scene_.retrace({.closest = arrays(work.closest),
                        .boxes = {mappedAs<shader::TraceBox>(work.boxes, work.boxCount), work.boxCount},
                        .changed = mappedAs<glm::uvec2>(work.changed, chunkCount_),
                        .ends = work.ends ? mappedAs<glm::uvec2>(work.ends, chunkCount_) : nullptr,
                        .rays = work.rays ? mappedAs<uint32_t>(work.rays, shader::kRayCounters) : nullptr,
                        .silent = work.silent});
    }

    void segments(VkCommandBuffer, const SegmentWork& work) override {
        const uint64_t words = (work.targetCount + 31) / 32;
        const uint32_t* listed =
            work.chunks ? mappedAs<uint32_t>(work.chunks, uint64_t{work.firstChunk} + work.chunkCount)
                        : nullptr;
        scene_.segments({.chunks = listed ? std::span(listed + work.firstChunk, work.chunkCount)
                                          : std::span<const uint32_t>(),
                         .firstChunk = work.firstChunk,
                         .chunkCount = work.chunkCount,
                         .targetCount = work.targetCount,
                         .targets = mappedAs<glm::vec4>(work.targets, uint64_t(work.chunkCount) *
                                                                          work.targetCount * shader::kChunk),
                         .bits = mappedAs<uint32_t>(work.bits, work.chunkCount * words * shader::kChunk),
                         .rays = work.rays ? mappedAs<uint32_t>(work.rays, shader::kRayCounters) : nullptr,
                         .covers = coversOf(work.covers),
                         .samplePass = work.samplePass,
                         .turn = work.turn,
                         .run = work.run});
    }

private:
    const shader::PatchCover* coversOf(const vk::Buffer* covers) const {
        return covers ? mappedAs<shader::PatchCover>(covers, uint64_t{chunkCount_} * shader::kChunk)
                      : nullptr;
    }
    ClosestArrays arrays(const ClosestWork& work) const {
        const uint64_t links =
            work.linksOffset + uint64_t(work.chunkCount) * work.sampleCount * shader::kChunk;
        return {.receivers = work.receiversHost,
                .firstChunk = work.firstChunk,
                .chunkCount = work.chunkCount,
                .firstSample = work.firstSample,
                .sampleCount = work.sampleCount,
                .rotation = work.rotation,
                .disc = work.disc ? mappedAs<glm::vec2>(work.disc, work.discCount) : nullptr,
                .discCount = work.discCount,
                .covers = coversOf(work.covers),
                .links = mappedAs<uint32_t>(work.links, links) + work.linksOffset};
    }

    uint32_t chunkCount_;
    EmbreeScene scene_;
};

} // namespace

std::unique_ptr<Tracer> makeEmbreeTracer(const TraceScene& scene, WorkerPool& pool) {
    return std::make_unique<EmbreeTracer>(scene, pool);
}

} // namespace relume
