#pragma once

#include <vector>

#include "bake/surface/patches.h"

namespace relume {

/// Senders that stand for several patches each, in chunks of 64, padded. A sender is a run of members (patch
/// indices), the one that stands for all first, and looks to the gather like a patch of its own.
struct SenderList {
    std::vector<shader::Sender> senders; // count: of members
    std::vector<uint32_t> members;
    std::vector<shader::Patch> patches;    // area: of all members; RTRad's: the first member
    std::vector<shader::PatchEdges> edges; // a parallelogram of that area
    std::vector<shader::ChunkBounds> bounds;
    std::vector<float> weights; // RTRad's only: texels that a sender counts for
    uint32_t count = 0;         // without padding

    uint32_t chunkCount() const { return static_cast<uint32_t>(bounds.size()); }
};

/// Makes one sender per window of edge x edge texels, aligned, chart and side. Only patches that send are
/// members, and the first is the one nearest to the middle of them. Senders are in order of tiles of 8 x 8
/// windows. edge is a power of two [texels].
SenderList windowSenders(const PatchSet& patches, uint32_t edge);

/// Makes RTRad's senders: one patch per window whose corner texel is one. jittered takes its Monte-Carlo
/// choice, else it is the corner. The weight is the window's number of texels.
SenderList rtradSenders(const PatchSet& patches, uint32_t edge, bool jittered);

/// Builds a list, sender by sender.
class SenderListBuilder {
public:
    explicit SenderListBuilder(const PatchSet& patches) : patches_(patches) {}
    /// Adds a sender of these members, at least one, in tile order. `first` is the index in members of the
    /// one that stands for all, key that of its random numbers.
    void add(const std::vector<uint32_t>& members, size_t first, uint32_t key);
    /// Adds a sender of RTRad's: a patch as it is that counts for so many texels.
    void addWeighted(uint32_t patch, float weight);
    /// Returns the list, padded to whole chunks, at least one. Bounds hold all members.
    SenderList finish();

private:
    void addShape(const shader::Patch& patch, const shader::PatchEdges& edges);

    const PatchSet& patches_;
    SenderList list_;
};

/// Returns the index of the member nearest to the middle of all, in texels; of equals the first.
size_t nearestToMiddle(const PatchSet& patches, const std::vector<uint32_t>& members);

/// Returns the key of the random numbers of a sender that begins with this patch.
uint32_t senderKey(const shader::Patch& first);

/// Returns per patch the number of its chart's side: patches of one number may be merged.
std::vector<uint32_t> mergeableParts(const PatchSet& patches);

} // namespace relume
