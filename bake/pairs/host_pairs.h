#pragma once

#include <span>

#include "bake/base/shader_types.h"
#include "assets/base/worker_pool.h"

namespace relume {

/// This gathers pairs on devices whose memory is the CPU's own: it makes the sums of
/// shaders/pairs/gather.comp in loops of C++, which are several times as fast as the shader on such a device.
/// All pointers are to what the passes have in their buffers (pair_passes.h), one entry per patch, padding
/// included, unless said otherwise. The same bytes come out whatever the number of threads.

/// The visible pairs of whole super-blocks; the exact form factor is taken where they are close.
struct HostPairs {
    std::span<const shader::SuperBlock> supers;
    std::span<uint32_t* const> bits; // of each super-block: tracer.h, OcclusionWork
    const shader::Patch* patches = nullptr;
    const shader::ChunkBounds* bounds = nullptr; // per chunk
    const uint32_t* sends = nullptr;             // per chunk of senders: whether any of them sends
    // These are the senders: the patches themselves, a list's, or those that `senders` and `members` draw
    // from.
    const shader::Patch* senderPatches = nullptr;
    const shader::PatchEdges* senderEdges = nullptr;
    const shader::ChunkBounds* senderBounds = nullptr; // per chunk of senders
    const glm::vec4* radiance = nullptr;
    const shader::Sender* senders = nullptr; // with these, each chunk of receivers draws one of each
    const uint32_t* members = nullptr;
    bool symmetric = false; // rows and columns are the same patches, bits hold i < j and serve both
    uint32_t rowCount = 0, columnCount = 0; // chunks
    // A vec4[super-block][2][kSuperPatches] is written: what the row's receivers get, then, where symmetric
    // and off the diagonal, what the column's get.
    glm::vec4* partial = nullptr;
};
void gatherPairs(WorkerPool& pool, const HostPairs& work);

} // namespace relume
