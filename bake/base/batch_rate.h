#pragma once

namespace relume {

/// A segment towards a light costs about this share of a closest hit.
constexpr double kSegmentCost = 0.3;
/// Less than this does not fill a GPU, and each submit costs 0.05 to 0.1 ms: unseen chunks that take no
/// longer come along with seen ones.
constexpr double kWorthASubmit = 0.5; // [ms]

/// Estimates how many chunks make a batch of so many milliseconds. A GPU that a batch does not fill takes as
/// long for half of it: there the time is seen as a latency that no smaller batch avoids and a part that
/// grows with the chunks, and a batch takes at least twice the latency, so that half of the device works.
class BatchRate {
public:
    /// Tells whether the device may be wider than a batch; a CPU's time is proportional to the chunks.
    explicit BatchRate(bool wide) : wide_(wide) {}

    double perMs() const { return chunks_ > 0 ? chunks_ / (share_ * ms_) : 0; } // [chunks/ms], 0: unknown
    double wanted(double batchMs) const;
    /// Takes note of a batch of these chunks that took `seconds`; batchMs was its aim.
    void note(double chunks, double batchMs, double seconds);

private:
    void noteShare(double chunks, double ms, double batchMs);

    bool wide_;
    double chunks_ = 0, ms_ = 0; // the batch from which others are foretold; chunks 0: none yet
    double share_ = 1;           // of its time that grows with the chunks
    bool shareKnown_ = false;
    double comparedChunks_ = 0, comparedMs_ = 0; // the batch with which later ones are compared
};

} // namespace relume
