#pragma once

#include <vector>

#include "bake/direct/penumbra.h"
#include "bake/gather/link_kit.h"
#include "bake/surface/tile_parts.h"

namespace relume {

/// The penumbra of the layer whose direct light is under way: the parts of tiles where neighbours see the
/// light unalike. The first sample pass finds it on the device, later ones heed it.
class PenumbraMap {
public:
    explicit PenumbraMap(LinkKit& kit);

    const TileParts& parts() const { return parts_; }
    const Penumbra& onDevice() const { return penumbra_; }

    /// Sets it from a mark per part; the device has it from the next recordUpload() on. Nothing may be under
    /// way that uses it.
    void set(const std::vector<uint8_t>& within);
    /// Forgets a set() that the device has not seen.
    void drop() { due_ = false; }
    /// Records that the device gets what set() said, where it has not seen it yet. The caller writes the
    /// barriers, here and below.
    void recordUpload(VkCommandBuffer cmd);
    void recordClear(VkCommandBuffer cmd) const;
    void clearOnCpu() const;

    /// Reads it back, to be asked by within() after the submit.
    void recordBack(VkCommandBuffer cmd) const;
    bool within(size_t part) const;

private:
    LinkKit& kit_;
    TileParts parts_;
    Penumbra penumbra_;
    vk::Buffer next_;  // penumbra_.lights as they are to be; none where the CPU sees these
    bool due_ = false; // next_ waits for the next submit
};

} // namespace relume
