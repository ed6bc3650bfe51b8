#pragma once

#include <span>

#include "bake/surface/patch_set.h"
#include "bake/surface/texture_group.h"
#include "bake/surface/triangle_frame.h"

namespace relume {

class WorkerPool;
struct KnownCovers;

/// Finds the part of its texel that each patch's surface covers: PatchSet::covers, coverCells and reach, from
/// the patches and the triangles that they lie on. frames has one entry per triangle. A point may lie in
/// cells where triangles of the patch's chart go on in its plane. Patches on masked triangles, backs and
/// those of thin charts keep their own points. It works on the pool, or on this thread alone. What is known
/// is taken from there.
void addCovers(PatchSet& set, const TextureGroup& group, std::span<const TriangleFrame> frames,
               WorkerPool* pool = nullptr, const KnownCovers* known = nullptr);

/// Returns how far samples may start from the patch's own point, at most [m].
float coverReach(const shader::PatchCover& cover);
/// Returns PatchSet::reach of a chunk.
float chunkReach(const PatchSet& set, uint32_t chunk);

} // namespace relume
