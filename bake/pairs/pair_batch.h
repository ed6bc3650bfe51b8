#pragma once

#include <functional>
#include <vector>

#include "bake/pairs/pair_walk.h"

namespace relume {

/// Part of a pass that is one submit: consecutive super-blocks. The first may be traced in part already, the
/// last may stay in part.
struct PairBatch {
    struct Super {
        uint32_t row = 0, column = 0; // as the plan has it
        UnitMask known;               // units whose bits are there
        UnitMask traced;              // units whose bits this batch traces
    };
    std::vector<Super> supers;
    uint32_t firstUnit = 0, endUnit = 0; // of the first and, plus 256 each, of the last super-block
    uint32_t complete = 0;               // super-blocks to gather, the first ones
    double tracedUnits = 0, gatheredUnits = 0;
    uint64_t pairs = 0;              // of the complete ones
    double cost = 0;                 // expected [ms]
    std::vector<uint32_t> rowsEnded; // rows of the walk that are through
};

/// Counts the units of a pass.
struct PairTally {
    uint64_t done = 0;       // of complete super-blocks
    uint64_t known = 0;      // of these, those whose bits were kept from earlier passes
    uint32_t superKnown = 0; // kept ones of the super-block under way
};

/// The time that units take, as measured so far.
class PairRates {
public:
    /// Takes note of a batch that took so long to trace and to gather.
    void learn(const PairBatch& batch, double traceMs, double gatherMs);
    bool gatherKnown() const { return msPerGathered_ > 0; }
    double traceCost(uint32_t units) const { return units * msPerTraced_; }
    double gatherCost(uint32_t units) const { return units * msPerGathered_; }
    /// Returns how many units may be traced in addition to what a batch of `aim` [ms] has already.
    uint32_t unitsThatFit(const PairBatch& batch, double aim) const;

private:
    double msPerTraced_ = 0, msPerGathered_ = 0; // unit, measured; 0: nothing yet
};

/// The things that decide what a batch is made of.
struct PairCut {
    /// Returns the units of a super-block, as the plan has it, whose bits are kept.
    std::function<UnitMask(uint32_t row, uint32_t column)> known;
    const PairRates& rates;
    double aim = 0;        // of the batch [ms]
    uint32_t capacity = 0; // super-blocks at most
};
/// Cuts the next batch off the walk; super-blocks in which nobody sends are left out. It is empty where
/// nothing else was left.
PairBatch cutPairBatch(PairWalk& walk, PairTally& tally, const PairCut& cut);

} // namespace relume
