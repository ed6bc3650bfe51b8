#pragma once

#include "bake/gather/link_passes.h"

namespace relume {

/// The ledger counts what link methods take as that of this owner (vk::MemoryOwner).
constexpr const char* kLinksOwner = "links";

/// Tells whether chunks get sample passes of their own. On a GPU they do not: what is left over of a map is
/// scattered in short runs of chunks, each of which would be a submit that hardly fills it.
bool samplesPerChunk(const SolverSettings& settings, bool software);

/// Tells whether chunks may have sample passes of direct light of their own: where errors decide how many
/// there are.
bool directApart(const SolverSettings& settings);

/// Returns the most bytes that LinkSolver takes at a time, beside LightBuffers. Where no number is
/// known for the cache (CacheSettings::bytes is 0), the links of a whole sample pass are kept.
SpilledBytes linkSolverBytes(const SolverExtent& extent, const SolverSettings& settings);

} // namespace relume
