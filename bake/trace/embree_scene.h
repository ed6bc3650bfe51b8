#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "assets/base/worker_pool.h"
#include "bake/base/retrace_types.h"
#include "bake/surface/trace_scene.h"
#include "bake/trace/tracer.h"

namespace relume {

/// OcclusionWork and ClosestWork (tracer.h) on plain memory.
struct OcclusionArrays {
    std::span<const SuperBlock> supers = {};
    std::span<uint32_t* const> bits = {}; // the bits of each super-block
    uint32_t firstUnit = 0, unitCount = 0;
    const uint32_t* sends = nullptr;              // per column chunk
    std::span<const shader::Sender> senders = {}; // empty: columns are chunks of patches
    std::span<const uint32_t> members = {};
    bool reversed = false;
    uint32_t* rays = nullptr; // may be left out
};
struct ClosestArrays {
    const shader::Patch* receivers = nullptr; // null: the scene's patches
    uint32_t firstChunk = 0, chunkCount = 0;
    uint32_t firstSample = 0, sampleCount = 0;
    Rotation rotation = Rotation::Patch;
    const glm::vec2* disc = nullptr;
    uint32_t discCount = 0;
    const shader::PatchCover* covers = nullptr;
    uint32_t* links = nullptr;
};

struct SegmentArrays {
    std::span<const uint32_t> chunks = {}; // empty: firstChunk and those behind it
    uint32_t firstChunk = 0, chunkCount = 0;
    uint32_t targetCount = 0;
    const glm::vec4* targets = nullptr;
    uint32_t* bits = nullptr;
    uint32_t* rays = nullptr; // may be left out
    const shader::PatchCover* covers = nullptr;
    uint32_t samplePass = 0, turn = 1, run = 1;

    uint32_t chunkOf(uint32_t number) const { return chunks.empty() ? firstChunk + number : chunks[number]; }
};

/// RetraceWork (tracer.h) on plain memory.
struct RetraceArrays {
    ClosestArrays closest;
    std::span<const shader::TraceBox> boxes = {};
    const glm::uvec2* changed = nullptr; // per chunk of all
    const glm::uvec2* ends = nullptr;    // likewise; nullptr: none
    uint32_t* rays = nullptr;            // may be left out
    bool silent = false;
};

/// The scene in Embree, traced in packets by a pool of threads; it needs no Vulkan. It borrows the
/// TraceScene. Results do not depend on the number of threads.
class EmbreeScene {
public:
    /// Builds the scene. The pool must outlive it. Throws Error when Embree cannot build.
    EmbreeScene(const TraceScene& scene, WorkerPool& pool);
    ~EmbreeScene();

    /// Does what Tracer::occlusion does. The bits of a skipped unit are left as they were, since nobody reads
    /// them; those of a unit that merely has no facing pair are cleared.
    void occlusion(const OcclusionArrays& work);
    /// Does what Tracer::closest does. A patch without kPatchSends gets kLinkDark for all samples.
    void closest(const ClosestArrays& work);
    void segments(const SegmentArrays& work);
    /// Does what Tracer::retrace does.
    void retrace(const RetraceArrays& work);
    void update();

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace relume
