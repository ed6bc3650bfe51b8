#pragma once

#include <optional>

#include "bake/base/chunk_order.h"
#include "bake/pairs/pair_plan.h"

namespace relume {

/// Goes through the super-blocks of a pass, row by row; rows that the camera sees come first. Where the
/// patches themselves send, a row is all super-blocks of its patches, as rows or as columns, that no earlier
/// row had: at its end its patches have all their light. It decides what comes next and nothing else.
class PairWalk {
public:
    /// A place within a pass: the next unit of the next super-block. Where the plan is symmetric, row and
    /// column stand in either order.
    struct Place {
        uint32_t row = 0, column = 0;
        uint32_t unit = 0; // 0 at a super-block's border
    };

    /// Serves passes over so many chunks of receivers.
    explicit PairWalk(uint32_t chunks) : rows_(PairPlan::superCount(chunks)) {}

    void begin(PairPlan plan);
    /// Goes on from this place; rows() must be what they were there.
    void resume(PairPlan plan, const Place& place);
    /// Leaves the pass, at its end or before.
    void leave() { place_.reset(); }
    /// Lets rows of super-blocks that have not begun come first where `seen`, one entry per row, is not 0;
    /// with none all are alike.
    void prefer(std::vector<uint8_t> seen);

    bool inPass() const { return place_.has_value(); }
    /// Tells whether all super-blocks of the pass have come.
    bool through() const { return place_->row >= plan_.superRows(); }
    const PairPlan& plan() const { return plan_; }
    const Place& place() const { return *place_; }
    /// Returns the next super-block as the plan has it: of a symmetric one the half above the diagonal.
    uint32_t row() const { return turned() ? place_->column : place_->row; }
    uint32_t column() const { return turned() ? place_->row : place_->column; }
    UnitMask units() const { return plan_.units(row(), column()); }
    /// Stays in the super-block, at a later unit.
    void stopAt(uint32_t unit) { place_->unit = unit; }
    /// Goes to the next super-block and returns the row that has ended, if one has.
    std::optional<uint32_t> next();

    bool isLeft(uint32_t row) const { return rows_.isLeft(row); }
    ChunkOrder& rows() { return rows_; }

private:
    bool turned() const { return plan_.symmetric() && place_->column < place_->row; }
    bool isDone(uint32_t column) const { return plan_.symmetric() && !rows_.isLeft(column); }
    uint32_t firstColumn() const;
    void nextRow();

    PairPlan plan_;
    ChunkOrder rows_;           // of super-blocks
    std::vector<uint8_t> seen_; // rows that come first
    std::optional<Place> place_;
};

} // namespace relume
