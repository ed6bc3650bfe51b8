#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace relume {

/// Tells how many sample passes of one kind each chunk has and is to have. A chunk takes its sample passes in
/// their order without a gap, so its samples depend on their number alone.
class ChunkSamplePasses {
public:
    explicit ChunkSamplePasses(uint32_t chunkCount) : done_(chunkCount, 0), wanted_(chunkCount, 0) {}

    /// Sets what each chunk is to have; less than it has means no more.
    void want(std::span<const uint32_t> samplePasses);
    /// Lets every chunk have one more than it has.
    void wantOneMore();
    /// Tells whether a chunk is to have more than it has.
    bool pending() const;

    /// Sample passes first .. first + count - 1 of the chunks that are marked.
    struct Pass {
        uint32_t first = 0, count = 0;
        std::vector<uint8_t> chunks; // 1: takes part
        bool all = false;            // every chunk does
    };
    /// Returns what comes next: the chunks that have the fewest of those that want more, and as many sample
    /// passes as all of these want, `most` (> 0) at most. Call it where some are pending.
    Pass next(uint32_t most) const;
    /// Notes that these were taken.
    void finish(const Pass& pass);

    std::span<const uint32_t> done() const { return done_; }
    /// Returns the most that a chunk has, and the fewest.
    uint32_t deepest() const;
    uint32_t shallowest() const;
    /// Returns the sum over all chunks.
    uint64_t total() const;

    /// Give the arrays to a stored state.
    std::vector<uint32_t>& doneArray() { return done_; }
    std::vector<uint32_t>& wantedArray() { return wanted_; }

private:
    std::vector<uint32_t> done_, wanted_;
};

} // namespace relume
