#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>
#include <span>
#include <vector>

#include "bake/ranks/shared_block.h"

namespace relume {

/// Tells that another process has failed, or was asked to end, and tells the user about it. It is no Error:
/// nobody takes it for something that can be mended here.
class OtherRankFailed final : public std::exception {
public:
    const char* what() const noexcept override { return "another process has failed"; }
};

/// Processes that bake one scene together, each of them with a number, its rank. All of them call gather(),
/// exchange(), sum(), share(), meet() and finish() in the same order: each waits for the others. Where one
/// has failed, the others learn it in their next call, which throws OtherRankFailed. Only one thread calls.
class Ranks {
public:
    virtual ~Ranks() = default;
    Ranks(const Ranks&) = delete;
    Ranks& operator=(const Ranks&) = delete;

    uint32_t rank() const { return rank_; }
    uint32_t count() const { return count_; }
    bool alone() const { return count_ == 1; }
    /// Tells whether this is the rank that writes files and talks to the user.
    bool speaks() const { return rank_ == 0; }

    /// Brings the bytes of all ranks to all: sizes[r] of rank r, which are this rank's `own`, stand in `all`
    /// behind those of the ranks before.
    void gather(std::span<const std::byte> own, std::span<std::byte> all, std::span<const uint64_t> sizes);

    struct Sent {
        uint32_t to = 0;
        std::span<const std::byte> bytes;
    };
    struct Received {
        uint32_t from = 0;
        std::span<std::byte> bytes;
    };
    /// Sends some bytes to some ranks, each of which must expect as many from this one, and receives others;
    /// at most one message goes from a rank to another.
    void exchange(std::span<const Sent> sent, std::span<const Received> received);

    /// Makes each value the sum over all ranks.
    void sum(std::span<uint64_t> values);
    uint64_t sum(uint64_t value);

    /// Returns memory that all ranks see, of as many bytes as all of them say; none where they run on several
    /// machines or one cannot have it.
    SharedBlock share(uint64_t bytes);
    /// Waits until all ranks are here: each sees then what the others had written to shared memory.
    void meet();

    /// Ends the work: waits until all have done theirs.
    void finish();
    /// Says, instead of whatever call comes next, that this rank has failed. Returns whether it is the one
    /// that tells the user, which is the first one of those that failed.
    [[nodiscard]] bool fail();

protected:
    Ranks(uint32_t rank, uint32_t count) : rank_(rank), count_(count) {}

private:
    /// Returns the smallest value of all ranks.
    virtual uint32_t least(uint32_t value) = 0;
    virtual void gatherAll(std::span<const std::byte> own, std::span<std::byte> all,
                           std::span<const uint64_t> sizes) = 0;
    virtual void exchangeSome(std::span<const Sent> sent, std::span<const Received> received) = 0;
    virtual void sumAll(std::span<uint64_t> values) = 0;
    virtual SharedBlock shareAll(uint64_t bytes) = 0;
    void agree();

    uint32_t rank_, count_;
};

/// Returns the ranks of a process that works alone: nothing goes anywhere.
Ranks& oneProcess();

} // namespace relume
