#include "bake/base/batch_rate.h"

#include <algorithm>
#include <cmath>

namespace relume {
namespace {

// The first batch of each kind has so many chunks, before anything is measured: it surely takes less than
// 50 ms.
constexpr double kFirstChunks = 16;
// A batch may grow this much over the one before: a first measurement may have caught shader compilation.
constexpr double kMaxGrowth = 4.0;
// The time of a batch this much shorter than wanted says little about longer ones.
constexpr double kShortBatch = 0.25;
// What does not get slower in larger batches is tried in steps of this size: chunks differ in cost, and a
// few cheap ones must not lead to a batch that is far too long.
constexpr double kProbe = 2.0;
// A batch of so many times the aim is not made longer only to learn.
constexpr double kTooLong = 4.0;
// Batches are compared if their sizes differ at least by this factor, and are of one size within this one.
constexpr double kDiffers = 1.25, kSameSize = 1.02;
// The latest comparison counts so much: chunks differ in cost.
constexpr double kNewest = 0.5;
// A share of 0 would ask for batches without end.
constexpr double kLeastShare = 0.05;
// A batch above the aim whose size does not change teaches nothing: its share is doubted until the size does.
constexpr double kDoubt = 0.97;
constexpr double kLeastMs = 1e-3; // below the clock's use

} // namespace

double BatchRate::wanted(double batchMs) const {
    if (chunks_ <= 0) return kFirstChunks;
    if (wide_ && !shareKnown_ && ms_ < kTooLong * batchMs)
        return std::max(kProbe * chunks_, chunks_ * std::min(batchMs / ms_, kMaxGrowth));
    const double latency = (1 - share_) * ms_;
    const double chunks = std::max(batchMs - latency, latency) * perMs();
    return wide_ ? std::clamp(chunks, chunks_ / kProbe, chunks_ * kMaxGrowth) : chunks;
}

void BatchRate::note(double chunks, double batchMs, double seconds) {
    if (chunks <= 0) return;
    double ms = std::max(kLeastMs, 1000.0 * seconds);
    if (wide_) {
        noteShare(chunks, ms, batchMs);
    } else if (chunks_ > 0) {
        const double known = perMs();
        if (chunks < kShortBatch * known * batchMs && chunks / ms < known) return;
        ms = std::max(ms, chunks / (kMaxGrowth * known));
    }
    // The rest of a pass may be far smaller than what was wanted, and would hold back what follows.
    if (wide_ && chunks < kShortBatch * chunks_) return;
    chunks_ = chunks;
    ms_ = ms;
}

// Two batches of different sizes n and times t tell which power of n the time follows: of t = a + b n this is
// the share b n / t, between 0 and 1.
void BatchRate::noteShare(double chunks, double ms, double batchMs) {
    const double ratio =
        comparedChunks_ > 0 ? std::max(chunks / comparedChunks_, comparedChunks_ / chunks) : 0;
    if (ratio >= kDiffers) {
        const double power = std::log(ms / comparedMs_) / std::log(chunks / comparedChunks_);
        const double measured = std::clamp(power, kLeastShare, 1.0);
        share_ = shareKnown_ ? (1 - kNewest) * share_ + kNewest * measured : measured;
        shareKnown_ = true;
    } else if (ms > batchMs) {
        share_ = std::max(kLeastShare, kDoubt * share_);
    }
    if (ratio > kSameSize && ratio < kDiffers) return; // small steps add up to one that tells
    comparedChunks_ = chunks;
    comparedMs_ = ms;
}

} // namespace relume
