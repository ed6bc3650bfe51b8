#pragma once

#include <span>

#include "bake/layers/object_move.h"
#include "bake/surface/trace_scene.h"

namespace relume {

/// Adds to a move where links end that would end elsewhere now: patches (ascending) have come, or send now or
/// no more. Links that end at one that sends nothing end beside it now; those that end around one that sends
/// may end there.
void addLinkEnds(const TraceScene& scene, std::span<const uint32_t> patches, ObjectMove& move);

} // namespace relume
