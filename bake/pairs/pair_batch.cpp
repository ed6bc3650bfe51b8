#include "bake/pairs/pair_batch.h"

#include <algorithm>

namespace relume {
namespace {

using shader::kSuperBlocks;

// The first batch of a bake traces so many units, not measured yet: it surely takes less than 50 ms.
constexpr uint32_t kFirstUnits = 16;
// A batch may grow this much over the one before: a first measurement may have caught shader compilation.
constexpr double kMaxGrowth = 4.0;

// Leaves the super-block behind.
void stepOn(PairWalk& walk, PairBatch& batch) {
    if (const std::optional<uint32_t> ended = walk.next()) batch.rowsEnded.push_back(*ended);
}

// Returns up to which unit a batch goes from `unit` on that traces so many of those that are missing.
uint32_t endOf(const UnitMask& missing, uint32_t unit, uint32_t most) {
    if (missing.count() <= most) return kSuperBlocks;
    for (; most > 0; ++unit)
        if (missing.has(unit)) --most;
    return unit;
}

// Adds the walk's super-block with these units; returns false when only a part of it fits.
bool addSuper(PairWalk& walk, PairTally& tally, const PairCut& cut, const UnitMask& units, PairBatch& batch) {
    PairBatch::Super super{.row = walk.row(), .column = walk.column(), .known = {}, .traced = {}};
    super.known = cut.known(super.row, super.column);
    const uint32_t unit = walk.place().unit;
    if (unit == 0) tally.superKnown = units.within(super.known).count();
    const UnitMask missing = units.without(super.known).within(UnitMask::range(unit, kSuperBlocks));
    const uint32_t end = endOf(missing, unit, cut.rates.unitsThatFit(batch, cut.aim));
    super.traced = missing.within(UnitMask::range(0, end));
    batch.supers.push_back(super);
    batch.tracedUnits += super.traced.count();
    batch.cost += cut.rates.traceCost(super.traced.count());
    batch.endUnit = static_cast<uint32_t>(batch.supers.size() - 1) * kSuperBlocks + end;
    if (end < kSuperBlocks) {
        walk.stopAt(end);
        return false;
    }
    tally.done += units.count();
    tally.known += tally.superKnown;
    batch.gatheredUnits += units.count();
    batch.cost += cut.rates.gatherCost(units.count());
    batch.pairs += walk.plan().pairs(super.row, super.column);
    ++batch.complete;
    stepOn(walk, batch);
    return true;
}

} // namespace

void PairRates::learn(const PairBatch& batch, double traceMs, double gatherMs) {
    const auto update = [](double& known, double measured) {
        known = known > 0 ? std::max(measured, known / kMaxGrowth) : measured;
    };
    constexpr double kLeast = 1e-6; // [ms], so that 0 stays "unknown"
    if (batch.tracedUnits > 0) update(msPerTraced_, std::max(kLeast, traceMs / batch.tracedUnits));
    if (batch.gatheredUnits > 0) update(msPerGathered_, std::max(kLeast, gatherMs / batch.gatheredUnits));
}

// A batch always goes some further.
uint32_t PairRates::unitsThatFit(const PairBatch& batch, double aim) const {
    const double room =
        msPerTraced_ > 0 ? (aim - batch.cost) / msPerTraced_ : kFirstUnits - batch.tracedUnits;
    const double least = batch.tracedUnits > 0 ? 0.0 : 1.0;
    return static_cast<uint32_t>(std::clamp(room, least, static_cast<double>(kSuperBlocks)));
}

PairBatch cutPairBatch(PairWalk& walk, PairTally& tally, const PairCut& cut) {
    PairBatch batch;
    batch.firstUnit = walk.place().unit;
    while (!walk.through() && batch.supers.size() < cut.capacity && batch.cost < cut.aim) {
        const UnitMask units = walk.units();
        if (units.count() == 0) {
            stepOn(walk, batch);
            continue;
        }
        if (!addSuper(walk, tally, cut, units, batch)) break;
        // One is enough to learn what gathering costs.
        if (!cut.rates.gatherKnown()) break;
    }
    return batch;
}

} // namespace relume
