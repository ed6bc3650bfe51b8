#pragma once

#include <cstdint>
#include <limits>
#include <vector>

namespace relume {

constexpr uint32_t kNoNumber = std::numeric_limits<uint32_t>::max();

/// Mixes a hash: it is the finalizer of a multiplicative hash, by which every bit of the input reaches the
/// low bits.
inline uint64_t mixBits(uint64_t h) {
    h ^= h >> 32;
    h *= 0xd6e8feb86659fd93ull;
    h ^= h >> 32;
    h *= 0xd6e8feb86659fd93ull;
    return h ^ (h >> 32);
}

/// Numbers keys from 0 on in the order of their first appearance. It uses open addressing, for at most so
/// many insertions.
template<typename Key>
class Numbering {
public:
    explicit Numbering(size_t insertions) {
        size_t slots = 16;
        while (slots < 2 * insertions)
            slots *= 2;
        slots_.assign(slots, kNoNumber);
    }
    /// Returns the number of `key`, or the next free one where it has none yet.
    uint32_t operator()(const Key& key, uint64_t hash) {
        size_t slot = hash & (slots_.size() - 1);
        while (slots_[slot] != kNoNumber && !(keys_[slots_[slot]] == key))
            slot = (slot + 1) & (slots_.size() - 1);
        if (slots_[slot] == kNoNumber) {
            slots_[slot] = static_cast<uint32_t>(keys_.size());
            keys_.push_back(key);
        }
        return slots_[slot];
    }
    size_t size() const { return keys_.size(); }
    const Key& key(uint32_t number) const { return keys_[number]; }

private:
    std::vector<uint32_t> slots_;
    std::vector<Key> keys_;
};

} // namespace relume
