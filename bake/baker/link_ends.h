#pragma once

#include <span>

#include "bake/layers/object_move.h"
#include "bake/surface/trace_scene.h"

namespace relume {

/// Adds to a move where links end that may end elsewhere now, as these patches (ascending) send now or no
/// more: a link that ends at one that sends nothing ends beside it now, and one that ends around one that
/// sends may end there.
void addLinkEnds(const TraceScene& scene, std::span<const uint32_t> patches, ObjectMove& move);

} // namespace relume
