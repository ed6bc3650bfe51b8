#include "bake/pairs/pair_plan.h"

#include <algorithm>

namespace relume {
namespace {

using shader::kChunk;
using shader::kSuper;

std::vector<uint32_t> chunkBits(uint32_t chunks) {
    std::vector<uint32_t> bits(PairPlan::superCount(chunks), 0);
    for (uint32_t chunk = 0; chunk < chunks; ++chunk)
        bits[chunk / kSuper] |= 1u << chunk % kSuper;
    return bits;
}

} // namespace

PairPlan::PairPlan(const Desc& desc, const std::vector<uint32_t>& sends)
    : desc_(desc), sends_(superCount(desc.columns), 0), there_(chunkBits(desc.columns)),
      rows_(chunkBits(desc.rows)) {
    for (uint32_t chunk = 0; chunk < desc.columns; ++chunk)
        if (sends[chunk] != 0) sends_[chunk / kSuper] |= 1u << chunk % kSuper;
    for (uint32_t row = 0; row < superRows(); ++row)
        for (uint32_t column = firstColumn(row); column < superColumns(); ++column)
            unitCount_ += units(row, column).count();
}

UnitMask PairPlan::units(uint32_t row, uint32_t column) const {
    UnitMask mask;
    if (!isOwn(row) && !(desc_.symmetric && isOwn(column))) return mask;
    if (sends_[column] == 0 && !(desc_.symmetric && sends_[row] != 0)) return mask;
    for (uint32_t r = 0; r < kSuper; ++r) {
        if ((rows_[row] >> r & 1u) == 0) continue;
        uint32_t columns = sends_[column];
        if (desc_.symmetric && (sends_[row] >> r & 1u) != 0) columns = there_[column];
        if (desc_.symmetric && row == column) columns &= ~0u << r;
        const uint32_t word = r / 2, shift = r % 2 * kSuper;
        (word < 4 ? mask.lo[int(word)] : mask.hi[int(word - 4)]) |= columns << shift;
    }
    return mask;
}

uint64_t PairPlan::pairs(uint32_t row, uint32_t column) const {
    const auto patches = [](uint32_t chunks, uint32_t super) {
        return uint64_t{std::min(kSuper, chunks - super * kSuper)} * kChunk;
    };
    const uint64_t count = patches(desc_.rows, row) * patches(desc_.columns, column);
    const bool turned = desc_.symmetric && row != column && isOwn(column);
    return (isOwn(row) ? count : 0) + (turned ? count : 0);
}

uint64_t PairPlan::superBlocks(const Desc& desc) {
    const uint64_t rows = superCount(desc.rows), columns = superCount(desc.columns);
    const uint64_t own = desc.own.empty()
                             ? rows
                             : rows - static_cast<uint64_t>(std::count(desc.own.begin(), desc.own.end(), 0));
    const auto halfOf = [](uint64_t edge) { return edge * (edge + 1) / 2; };
    return desc.symmetric ? halfOf(rows) - halfOf(rows - own) : own * columns;
}

} // namespace relume
