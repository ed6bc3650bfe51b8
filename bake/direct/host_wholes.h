#pragma once

#include <cstdint>
#include <span>

#include "assets/base/worker_pool.h"
#include "bake/base/chunk_order.h"
#include "bake/base/shader_types.h"

namespace relume {

/// One mesh light and the patches that are to learn what all of it brings without shadows, for devices whose
/// memory is the CPU's own: a kernel would load each edge for each patch.
struct HostWholes {
    std::span<const shader::EmitterPolygon> polygons;
    std::span<const shader::EmitterEdge> edges; // emitterEdges()
    const shader::EmitterNode& root;            // of the light tree
    std::span<const shader::Patch> patches;     // all, padding included
    const shader::PatchCover* covers =
        nullptr;                 // of all, where samples start; nullptr: at patches' own points
    std::span<glm::vec4> wholes; // of all patches, as of EmitterSamplesPush
    ChunkRange range;            // those to be found
};
void findWholes(WorkerPool& pool, const HostWholes& work);

} // namespace relume
