#pragma once

#include <algorithm>
#include <cstdint>

namespace relume {

/// A segment towards a light costs about this share of a closest hit.
constexpr double kSegmentCost = 0.3;
/// Less than this does not fill a GPU, and each submit costs 0.05 to 0.1 ms: unseen chunks that take no
/// longer come along with seen ones.
constexpr double kWorthASubmit = 0.5; // [ms]

/// Estimates how many chunks make a batch of so many milliseconds.
class BatchRate {
public:
    double perMs() const { return rate_; } // [chunks/ms], 0: not measured yet
    double wanted(double batchMs) const { return rate_ > 0 ? rate_ * batchMs : kFirstChunks; }
    /// Takes note of a batch of these chunks that took `seconds`; batchMs was its aim.
    void note(double chunks, double batchMs, double seconds) {
        const double measured = chunks / std::max(1e-3, 1000.0 * seconds);
        if (chunks < kShortBatch * rate_ * batchMs && measured < rate_) return;
        rate_ = rate_ > 0 ? std::min(measured, kMaxGrowth * rate_) : measured;
    }

private:
    // The first batch of each kind has so many chunks, before anything is measured: it surely takes less than
    // 50 ms.
    static constexpr double kFirstChunks = 16;
    // A batch may grow this much over the one before: a first measurement may have caught shader compilation.
    static constexpr double kMaxGrowth = 4.0;
    // The time of a batch this much shorter than wanted says little about longer ones.
    static constexpr double kShortBatch = 0.25;

    double rate_ = 0;
};

} // namespace relume
