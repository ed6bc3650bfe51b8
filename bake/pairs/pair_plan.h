#pragma once

#include <vector>

#include "bake/pairs/bits_cache.h"

namespace relume {

/// Tells which units of a pass have a sender. Rows are chunks of patches, columns chunks of senders. Where it
/// is symmetric both are of the same patches: a unit serves both of its chunks, and those behind the diagonal
/// are left out.
class PairPlan {
public:
    struct Desc {
        uint32_t rows = 0, columns = 0; // chunks
        bool symmetric = true;
        /// Per row of super-blocks, not 0: its patches get their light here; empty: all do. Super-blocks that
        /// give none of them any have no units.
        std::vector<uint8_t> own = {};
    };
    PairPlan() = default;
    /// Plans for `sends`: per column chunk, 0 where nothing in it sends.
    PairPlan(const Desc& desc, const std::vector<uint32_t>& sends);

    uint32_t superRows() const { return superCount(desc_.rows); }
    uint32_t superColumns() const { return superCount(desc_.columns); }
    bool symmetric() const { return desc_.symmetric; }
    /// Returns the first column of a row of super-blocks.
    uint32_t firstColumn(uint32_t row) const { return desc_.symmetric ? row : 0; }
    UnitMask units(uint32_t row, uint32_t column) const;
    uint64_t unitCount() const { return unitCount_; } // of the pass
    /// Returns the number of receiver-sender pairs of a super-block whose receivers are own ones, both ways
    /// where it is symmetric.
    uint64_t pairs(uint32_t row, uint32_t column) const;

    static uint32_t superCount(uint32_t chunks) { return (chunks + shader::kSuper - 1) / shader::kSuper; }
    /// Returns the number of super-blocks of a pass that may have units.
    static uint64_t superBlocks(const Desc& desc);

private:
    bool isOwn(uint32_t row) const { return desc_.own.empty() || desc_.own[row] != 0; }

    Desc desc_;
    std::vector<uint32_t> sends_;        // of super-columns, a bit per chunk
    std::vector<uint32_t> there_, rows_; // likewise: chunks that exist, and those of rows
    uint64_t unitCount_ = 0;
};

} // namespace relume
