#pragma once

#include "bake/layers/layer.h"
#include "bake/layers/object_move.h"
#include "bake/surface/tile_parts.h"

namespace relume {

/// A move of objects, as direct light meets it.
struct MoveReach {
    WorkerPool& pool;
    const PatchSet& patches;
    const TileParts& parts;
    const ObjectMove& move;
    float reach = 0;      // how far away rays to suns and the sky end [m]
    bool farther = false; // they end elsewhere than before the move
};

/// Marks the chunks of the layer (Layer::dirty) whose direct light may be another one after the move, and
/// those beside them.
void markDirty(const MoveReach& moved, Layer& layer);

} // namespace relume
