#pragma once

#include <compare>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>

namespace relume::vk {

/// Counts the memory that is allocated on a device and, for it, on the host, by owner and name. Any thread
/// may use it.
class MemoryLedger {
public:
    /// Tells whose memory it is ("pairs") and what it holds ("partial sums").
    struct Key {
        std::string owner, name;
        bool ofHost = false; // Memory::Host
        auto operator<=>(const Key&) const = default;
    };
    /// The memory of one key. Its address holds as long as the ledger.
    struct Account {
        uint64_t bytes = 0;
        bool ofHost = false;
    };

    /// Returns the account for memory of this name and the calling thread's MemoryOwner.
    Account& open(const std::string& name, bool ofHost = false);
    void add(Account& account, uint64_t bytes);
    void remove(Account& account, uint64_t bytes);

    uint64_t bytes() const; // allocated now
    /// Returns those of them that are not Memory::Host.
    uint64_t deviceBytes() const;
    /// Returns the bytes of one owner now.
    uint64_t bytesOf(const std::string& owner) const;
    /// Returns those of them that are not Memory::Host.
    uint64_t deviceBytesOf(const std::string& owner) const;
    /// Returns the most bytes that were allocated at a time since resetPeak(), or since the beginning.
    uint64_t peak() const;
    /// Returns the same of deviceBytes().
    uint64_t devicePeak() const;
    void resetPeak();
    /// Returns the bytes of all keys that hold memory now.
    std::map<Key, uint64_t> entries() const;

    /// Returns how often memory was asked for so far.
    uint64_t allocations() const;
    /// Lets the n-th allocation from now on (1: the next one) fail as on a full device, once. This is for
    /// tests.
    void failAt(uint64_t n);
    /// Withdraws failAt(), and returns whether that allocation never came.
    bool withdrawFailure();
    /// Notes that memory is asked for, and returns false where this one must fail.
    [[nodiscard]] bool admit();

private:
    mutable std::mutex mutex_;
    std::map<Key, Account> accounts_;
    uint64_t bytes_ = 0, peak_ = 0;
    uint64_t deviceBytes_ = 0, devicePeak_ = 0;
    uint64_t allocations_ = 0;
    std::optional<uint64_t> untilFailure_; // allocations up to the one that fails
};

/// Names the owner of the memory that this thread allocates, as long as this object lives; the innermost one
/// counts.
class MemoryOwner {
public:
    explicit MemoryOwner(const char* name); // lives longer than this
    ~MemoryOwner();
    MemoryOwner(const MemoryOwner&) = delete;
    MemoryOwner& operator=(const MemoryOwner&) = delete;

private:
    const char* before_;
};

} // namespace relume::vk
