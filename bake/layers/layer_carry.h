#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "bake/gather/link_batches.h"
#include "bake/layers/dirty_chunks.h"
#include "bake/layers/layer_store.h"
#include "bake/surface/patch_carry.h"

namespace relume {

/// Holds what a solver of layers leaves for another one of the same level, whose meshes, materials or objects
/// were edited.
struct FormerLayers {
    std::vector<std::unique_ptr<Layer>> layers;
    SceneState state;                        // of the layers that have followed all edits
    std::deque<LinkCache::SamplePass> links; // by sample pass
    uint32_t linksOfSamplePass = 0;          // links per patch and sample pass
    std::optional<ObjectMove> pending;       // a move that some links have not followed yet
    std::vector<uint32_t> partOfPatch;       // TileParts::ofPatch
    float reach = 0;                         // how far away rays to suns and the sky end [m]
    std::vector<glm::vec4> shown; // the light that a viewer was shown, per patch; empty: not all of it
    SolverProgress progress;

    uint64_t bytes() const; // on the device
    /// Drops links, the last sample passes first, and then all layers, until no more is left than so many
    /// bytes.
    void keepWithin(uint64_t bytes);
};

/// Says how a solver of layers goes on with what another one has left.
struct LayerCarry {
    FormerLayers& former; // is used up
    const PatchCarry& patches;
    const ObjectMove& move; // of this scene's patches: what is to be traced again
    // The former patch of each texel. A patch that was not there shows its light at first.
    std::span<const uint32_t> formerTexels = {};
    bool sameSky = false;     // its picture is the one that it was
    bool sameColours = false; // sameColours() of the patches
};

/// The links of `samples` samples of a chunk's patches, links[sample][64], with the patches' new numbers. A
/// link to a patch that is no more, and those of patches that were not there, are dark: they are to be traced
/// again. Chunks are counted in the patches that there are now.
void carryLinks(const PatchCarry& carry, uint32_t chunk, uint32_t samples, std::span<const uint32_t> from,
                uint32_t* to);

/// Returns which chunks have all links that are to be carried over; `known` says so of former ones.
std::vector<uint8_t> carryKnown(const PatchCarry& carry, std::span<const uint8_t> known);

/// Returns a move of former patches as one of these patches: those that were not there have changed.
ObjectMove carryMove(const PatchCarry& carry, const ObjectMove& move);

/// Returns values per former patch as values per patch, 0 for those that were not there.
std::vector<glm::vec4> carryValues(const PatchCarry& carry, std::span<const glm::vec4> from);

/// Returns what was shown as light of these patches. Those that were not there have that of the patch which
/// had their texel, or none.
std::vector<glm::vec4> carryShown(const LayerCarry& carry, const PatchSet& patches);

/// Returns the cache key that a layer of this light had in the former scene, of no state; nothing where it
/// had none, or its light cannot be told apart.
std::optional<LightCacheKey> formerCacheKey(const LightCacheKey& cacheKey, const LayerCarry& carry);

/// Tells what has come along.
struct CarriedWork {
    std::optional<ObjectMove> relink; // what links are to be traced again for; nothing where that is none
    bool whole = true;                // each layer shows what it did
    uint32_t layers = 0;              // that have direct light
};

/// Gives each layer what the former one of its light has of direct light, as far as the move leaves it, and
/// where nothing changed its result. Fills the cache, which is empty, with links.
CarriedWork carryLayers(LinkKit& kit, LayerStore& store, LinkCache& cache, const MoveReach& reach,
                        const LayerCarry& carry);

} // namespace relume
