#pragma once

#include <cstdint>
#include <cstring>
#include <random>
#include <span>
#include <vector>

#include <sys/mman.h>
#include <unistd.h>

namespace relume::test {

/// Holds bytes that end where a page begins that nobody may read: a read past the end is a crash, also in
/// libraries that no sanitizer looks into.
class GuardedBytes {
public:
    explicit GuardedBytes(std::span<const uint8_t> bytes) : size_(bytes.size()) {
        const size_t page = static_cast<size_t>(sysconf(_SC_PAGESIZE));
        const size_t held = (size_ + page - 1) / page * page;
        mapped_ = held + page;
        memory_ = static_cast<uint8_t*>(
            mmap(nullptr, mapped_, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0));
        mprotect(memory_ + held, page, PROT_NONE);
        begin_ = memory_ + held - size_;
        if (size_ > 0) std::memcpy(begin_, bytes.data(), size_);
    }
    ~GuardedBytes() { munmap(memory_, mapped_); }
    GuardedBytes(const GuardedBytes&) = delete;
    GuardedBytes& operator=(const GuardedBytes&) = delete;

    std::span<const uint8_t> span() const { return {begin_, size_}; }

private:
    size_t size_ = 0, mapped_ = 0;
    uint8_t *memory_ = nullptr, *begin_ = nullptr;
};

/// Returns the bytes with one to four of them changed, now and then cut short, the same for the same number.
inline std::vector<uint8_t> mutated(std::span<const uint8_t> bytes, uint32_t number) {
    std::mt19937 random(number);
    std::vector<uint8_t> out(bytes.begin(), bytes.end());
    for (uint32_t i = 0; i < 1 + number % 4; ++i)
        out[random() % out.size()] = static_cast<uint8_t>(random());
    if (number % 5 == 0) out.resize(random() % out.size());
    return out;
}

} // namespace relume::test
