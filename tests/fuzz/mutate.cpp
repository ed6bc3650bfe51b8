#include "tests/fuzz/fuzz.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>
#include <random>

namespace relume::fuzz {
namespace {

constexpr size_t kMostBytes = 64 << 10; // of an input

// Sizes, counts, offsets and indices go wrong at these values.
constexpr std::array<uint64_t, 17> kIntegers = {
    0,       1,        2,          3,          7,          255,        256,        0x7fff,      0xffff,
    0x10000, 0xffffff, 0x7fffffff, 0x80000000, 0xfffffffe, 0xffffffff, 1ull << 40, ~uint64_t{0}};
constexpr std::array<const char*, 22> kTexts = {
    "0",     "-1",     "1",          "2",          "0.5",
    "-0.0",  "1e30",   "-1e38",      "1e300",      "1e-45",
    "255",   "65536",  "4294967295", "2147483647", "18446744073709551615",
    "null",  "true",   "\"\"",       "[]",         "{}",
    "\"x\"", "[0,1,2]"};

class Mutator {
public:
    Mutator(const std::vector<std::string>& corpus, uint64_t seed, uint64_t run)
        : corpus_(corpus), random_((seed << 32) ^ run) {}

    std::string run() {
        bytes_ = corpus_[below(corpus_.size())];
        do
            change();
        while (below(3) != 0);
        if (bytes_.size() > kMostBytes) bytes_.resize(kMostBytes);
        return std::move(bytes_);
    }

private:
    size_t below(size_t bound) { return bound > 0 ? static_cast<size_t>(random_() % bound) : 0; }
    /// Returns a length, mostly of up to 16 bytes, at times of anything up to all that is left.
    size_t lengthFrom(size_t begin) {
        const size_t left = bytes_.size() - begin;
        return std::min(left, below(8) == 0 ? below(left + 1) : 1 + below(16));
    }

    void change() {
        if (bytes_.empty()) {
            insertBytes();
            return;
        }
        switch (below(10)) {
        case 0:
            flipBit();
            break;
        case 1:
            bytes_[below(bytes_.size())] = static_cast<char>(random_());
            break;
        case 2:
        case 3:
            overwriteInteger();
            break;
        case 4:
            erase();
            break;
        case 5:
            insertBytes();
            break;
        case 6:
            copyWithin();
            break;
        case 7:
            copyFromAnother();
            break;
        default:
            replaceNumber();
            break;
        }
    }
    void flipBit() {
        char& byte = bytes_[below(bytes_.size())];
        byte = static_cast<char>(byte ^ 1 << below(8));
    }
    void overwriteInteger() {
        const size_t size = size_t{1} << below(4), at = below(bytes_.size());
        uint64_t value = kIntegers[below(kIntegers.size())];
        if (below(4) == 0) value = bytes_.size() + below(9) - 4;
        char raw[sizeof(value)];
        std::memcpy(raw, &value, sizeof(value));
        if (below(2) == 0) std::reverse(raw, raw + size); // PNG has the highest byte first
        std::copy_n(raw, std::min(size, bytes_.size() - at),
                    bytes_.begin() + static_cast<std::ptrdiff_t>(at));
    }
    void erase() {
        const size_t at = below(bytes_.size());
        bytes_.erase(at, lengthFrom(at));
    }
    void insertBytes() {
        std::string inserted(1 + below(16), '\0');
        if (below(2) == 0)
            for (char& byte : inserted)
                byte = static_cast<char>(random_());
        bytes_.insert(below(bytes_.size() + 1), inserted);
    }
    void copyWithin() {
        const size_t from = below(bytes_.size());
        const std::string piece = bytes_.substr(from, lengthFrom(from));
        put(piece);
    }
    void copyFromAnother() {
        const std::string& other = corpus_[below(corpus_.size())];
        const size_t from = below(other.size());
        put(other.substr(from, below(8) == 0 ? other.size() : 1 + below(64)));
    }
    void put(const std::string& piece) {
        const size_t at = below(bytes_.size() + 1);
        bytes_.replace(at, below(2) == 0 ? piece.size() : 0, piece);
    }
    /// Gives the next number of a text another value.
    void replaceNumber() {
        const auto isDigit = [](unsigned char c) { return std::isdigit(c) != 0; };
        const auto from = bytes_.begin() + static_cast<std::ptrdiff_t>(below(bytes_.size()));
        const auto begin = std::find_if(from, bytes_.end(), isDigit);
        const auto end = std::find_if_not(begin, bytes_.end(), isDigit);
        if (begin == bytes_.end()) return;
        const std::string text = below(3) == 0 ? std::to_string(kIntegers[below(kIntegers.size())])
                                               : std::string(kTexts[below(kTexts.size())]);
        bytes_.replace(begin, end, text);
    }

    const std::vector<std::string>& corpus_;
    std::mt19937_64 random_;
    std::string bytes_;
};

} // namespace

std::string inputOf(const std::vector<std::string>& corpus, uint64_t seed, uint64_t run) {
    return run < corpus.size() ? corpus[run] : Mutator(corpus, seed, run).run();
}

} // namespace relume::fuzz
