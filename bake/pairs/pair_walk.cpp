#include "bake/pairs/pair_walk.h"

#include <utility>

namespace relume {

void PairWalk::begin(PairPlan plan) {
    plan_ = std::move(plan);
    rows_.begin(plan_.superRows(), seen_);
    place_ = Place{};
    nextRow();
}

void PairWalk::resume(PairPlan plan, const Place& place) {
    plan_ = std::move(plan);
    rows_.restore(plan_.superRows(), seen_);
    place_ = place;
}

void PairWalk::prefer(std::vector<uint8_t> seen) {
    seen_ = std::move(seen);
    if (!inPass()) return;
    rows_.prefer(seen_);
    const bool begun = place_->unit > 0 || place_->column != firstColumn();
    if (!begun) nextRow();
}

std::optional<uint32_t> PairWalk::next() {
    place_->unit = 0;
    do
        ++place_->column;
    while (place_->column < plan_.superColumns() && isDone(place_->column));
    if (place_->column < plan_.superColumns()) return {};
    const uint32_t ended = place_->row;
    rows_.finish({ended, 1});
    nextRow();
    return ended;
}

void PairWalk::nextRow() {
    place_->row = rows_.left() > 0 ? rows_.next(1, 0).first : plan_.superRows();
    place_->column = firstColumn();
    place_->unit = 0;
}

// Returns the first column of a row that has not begun: the row of the patches that send in it has not had
// its super-blocks before.
uint32_t PairWalk::firstColumn() const {
    uint32_t column = 0;
    while (column < plan_.superColumns() && isDone(column))
        ++column;
    return column;
}

} // namespace relume
