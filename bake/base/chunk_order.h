#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace relume {

/// Consecutive chunks.
struct ChunkRange {
    uint32_t first = 0, count = 0;
    bool operator==(const ChunkRange&) const = default;
};

/// Returns the same chunks in ascending order, each once, in as few ranges as possible.
std::vector<ChunkRange> merged(std::vector<ChunkRange> ranges);

/// Returns the chunks whose mark is not 0 (`marked`), or is 0, in as few ranges as possible; each chunk has
/// one mark.
std::vector<ChunkRange> rangesOf(const std::vector<uint8_t>& marks, bool marked);
/// Marks the runs of up to `most` chunks between marked ones, too.
void closeGaps(std::vector<uint8_t>& marks, uint32_t most);

/// Tells which chunks of a pass are still to be done, and which of them come next.
class ChunkOrder {
public:
    /// Serves passes of up to `capacity` chunks.
    explicit ChunkOrder(uint32_t capacity) : marks_(capacity, 0) {}

    /// Begins a pass over `count` chunks of which none is done; `seen` is as for prefer().
    void begin(uint32_t count, const std::vector<uint8_t>& seen);
    /// Begins a pass over the chunks whose mark is not 0.
    void beginMarked(const std::vector<uint8_t>& marks, const std::vector<uint8_t>& seen);
    /// Lets chunks whose `seen` is not 0 come before the others from now on; it has one entry per chunk, or
    /// none: all are alike.
    void prefer(const std::vector<uint8_t>& seen);
    uint32_t count() const { return count_; } // chunks of the pass
    uint32_t left() const { return left_; }
    bool prefersSome() const { return preferred_ > 0; } // of those that are left
    bool isLeft(uint32_t chunk) const { return marks_[chunk] != 0; }
    /// Returns what comes next: up to `most` (> 0) consecutive chunks that are left, from the first preferred
    /// one on, or from the first one where none is preferred: fewer where a short rest of their run would be
    /// left. A run of preferred ones goes on to the next run over no more than `gap` others. A count of 0
    /// means that none is left.
    ChunkRange next(uint32_t most, uint32_t gap) const;
    /// Returns up to `most` (> 0) chunks that are left, ascending, wherever they are: preferred ones alone,
    /// where there are some.
    std::vector<uint32_t> nextOnes(uint32_t most) const;
    void finish(ChunkRange range);
    void finish(std::span<const uint32_t> chunks);

    /// Returns one byte per chunk of the capacity, 0: done or beyond the pass. A state stores them; they are
    /// written before restore().
    std::vector<uint8_t>& marks() { return marks_; }
    void restore(uint32_t count, const std::vector<uint8_t>& seen);

private:
    std::vector<uint8_t> marks_; // 0: done, kLeft, kPreferred
    uint32_t count_ = 0, left_ = 0, preferred_ = 0;
};

} // namespace relume
