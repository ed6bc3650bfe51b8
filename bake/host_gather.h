#pragma once

#include <span>

#include "bake/shader_types.h"
#include "bake/worker_pool.h"

namespace relume {

/// The gathers for devices whose memory is the CPU's own: the sums of shaders/links.comp and gather.comp in
/// loops of C++, several times as fast as the shaders on such a device. All pointers are to what the passes
/// have in their buffers (link_passes.h, passes.h), one entry per patch, padding included, unless said
/// otherwise. The same bytes come out whatever the number of threads.

/// Links of chunks firstChunk .. firstChunk + chunkCount - 1.
struct HostLinks {
    const uint32_t* links = nullptr;     // [chunk - firstChunk][samples][64]
    const glm::vec4* radiance = nullptr; // of what links may end at [cd/m^2]
    const glm::vec4* direct = nullptr;   // added to ligOut where there is one
    glm::vec4* ligOut = nullptr;         // direct + the mean over the samples; may be none
    glm::vec4* sums = nullptr;           // [kReplicates][patchCount], added to; may be none
    bool newSums = false;                // nothing is in these yet
    uint32_t firstChunk = 0, chunkCount = 0;
    uint32_t samples = 0; // a multiple of kReplicates
    uint32_t patchCount = 0;
};
void gatherLinks(WorkerPool& pool, const HostLinks& work);

/// After a bounce: what patches send next, and how much the light changed.
struct HostSend {
    const shader::Patch* patches = nullptr;
    const glm::vec4* albedo = nullptr;
    const glm::vec4* before = nullptr; // of the bounce
    const glm::vec4* light = nullptr;  // that came of it
    glm::vec4* radiance = nullptr;     // written: reflectivity * albedo * light, of those that send
    glm::vec4* changes = nullptr;      // per chunk, as of ChangePush; nullptr: not told
    const uint8_t* full = nullptr;     // per chunk, not 0: all of its patches send and are shown
    float reflectivity = 1;
    uint32_t chunkCount = 0;
};
void sendLight(WorkerPool& pool, const HostSend& work);

/// Visible pairs of whole super-blocks, by the exact form factor where they are close.
struct HostPairs {
    std::span<const shader::SuperBlock> supers;
    std::span<uint32_t* const> bits; // of each super-block: tracer.h, OcclusionWork
    const shader::Patch* patches = nullptr;
    const shader::ChunkBounds* bounds = nullptr; // per chunk
    const uint32_t* sends = nullptr;             // per chunk of senders: whether any of them sends
    // Of the senders: the patches themselves, a list's, or those that `senders` and `members` draw from.
    const shader::Patch* senderPatches = nullptr;
    const shader::PatchEdges* senderEdges = nullptr;
    const shader::ChunkBounds* senderBounds = nullptr; // per chunk of senders
    const glm::vec4* radiance = nullptr;
    const shader::Sender* senders = nullptr; // with these, each chunk of receivers draws one of each
    const uint32_t* members = nullptr;
    bool symmetric = false; // rows and columns are the same patches, bits hold i < j and serve both
    uint32_t rowCount = 0, columnCount = 0; // chunks
    // vec4[super-block][2][kSuperPatches], written: what the row's receivers get, then, symmetric and off the
    // diagonal, the column's.
    glm::vec4* partial = nullptr;
};
void gatherPairs(WorkerPool& pool, const HostPairs& work);

} // namespace relume
