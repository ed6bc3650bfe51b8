#pragma once

#include <cstdint>
#include <vector>

namespace relume {

/// Consecutive chunks.
struct ChunkRange {
    uint32_t first = 0, count = 0;
    bool operator==(const ChunkRange&) const = default;
};

/// The same chunks in ascending order, each once, in as few ranges as possible.
std::vector<ChunkRange> merged(std::vector<ChunkRange> ranges);

/// Those whose mark is not 0 (`marked`) or is, one mark per chunk, as few ranges as possible.
std::vector<ChunkRange> rangesOf(const std::vector<uint8_t>& marks, bool marked);
/// Marks runs of up to `most` chunks between marked ones, too.
void closeGaps(std::vector<uint8_t>& marks, uint32_t most);

/// Which chunks of a pass are still to be done, and which of them come next.
class ChunkOrder {
public:
    /// For passes of up to so many chunks.
    explicit ChunkOrder(uint32_t capacity) : marks_(capacity, 0) {}

    /// A pass over `count` chunks of which none is done. seen: as for prefer.
    void begin(uint32_t count, const std::vector<uint8_t>& seen);
    /// From now on those that are not 0 come before the others; one per chunk, or empty: all are alike.
    void prefer(const std::vector<uint8_t>& seen);
    uint32_t count() const { return count_; } // of the pass
    uint32_t left() const { return left_; }
    bool isLeft(uint32_t chunk) const { return marks_[chunk] != 0; }
    /// What comes next: up to `most` (> 0) consecutive chunks that are left, from the first preferred one on,
    /// or from the first one where none is preferred. A run of preferred ones goes on to the next run over no
    /// more than `gap` others. Count 0: none is left.
    ChunkRange next(uint32_t most, uint32_t gap) const;
    void finish(ChunkRange range);

    /// One byte per chunk of the capacity, 0: done or beyond the pass. To be stored, and written before
    /// restore.
    std::vector<uint8_t>& marks() { return marks_; }
    void restore(uint32_t count, const std::vector<uint8_t>& seen);

private:
    std::vector<uint8_t> marks_; // 0: done, kLeft, kPreferred
    uint32_t count_ = 0, left_ = 0, preferred_ = 0;
};

} // namespace relume
