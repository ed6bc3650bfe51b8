#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <glm/glm.hpp>

#include "assets/atlas/texel_mask.h"

namespace relume {

/// A mask that is looked for a place for, as its runs.
struct MaskShape {
    explicit MaskShape(const TexelMask& mask);

    uint32_t width, height;     // of the box [texels]
    std::vector<TexelRun> runs; // the longest first, each row's again later: these rule out most places
};

/// The texels of an atlas that masks have taken. Looks for the lowest place where a mask meets none of them,
/// for all columns at once, by shifted words of 64 texels.
class MaskAtlas {
public:
    MaskAtlas(uint32_t width, uint32_t height);

    /// Returns the column and row of the lowest place, and of these the leftmost, at which the whole box lies
    /// in the atlas and no texel is taken twice; its row is `firstRow` or above, and at most `lastRow`.
    std::optional<glm::uvec2> lowestPlace(const MaskShape& shape, uint32_t firstRow, uint32_t lastRow) const;
    bool isFree(const MaskShape& shape, glm::uvec2 place) const;
    void add(const MaskShape& shape, glm::uvec2 place);
    uint32_t width() const { return width_; }
    uint32_t height() const { return height_; }

private:
    const uint64_t* row(uint32_t level, uint32_t y) const {
        return taken_[level].data() + size_t(y) * words_;
    }
    std::optional<uint32_t> freeColumn(const MaskShape& shape, uint32_t y) const;
    void measureRow(uint32_t y);

    uint32_t width_, height_, words_;
    // Bit x of level k tells whether one of the texels [x, x + 2^k) is taken.
    std::vector<std::vector<uint64_t>> taken_;
    std::vector<uint32_t> longestFree_; // run of each row, or more than that
    std::vector<uint32_t> changes_;     // of each row
    mutable std::vector<uint64_t> met_; // scratch: columns at which the mask meets a taken texel
};

} // namespace relume
