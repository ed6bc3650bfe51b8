#pragma once

#include <cstddef>
#include <span>
#include <utility>

#include "assets/base/worker_pool.h"

namespace relume {

/// Memory in whole pages straight from the system, all zero; move-only. A pool's threads get it together,
/// for one alone takes long to clear many pages.
class HostPages {
public:
    HostPages() = default;
    /// Gets `bytes` of memory, a multiple of kGrain; empty where the system has none to give.
    HostPages(WorkerPool& pool, size_t bytes);
    ~HostPages() { release(); }
    HostPages(HostPages&& other) noexcept : bytes_(std::exchange(other.bytes_, {})) {}
    HostPages& operator=(HostPages&& other) noexcept {
        if (this != &other) {
            release();
            bytes_ = std::exchange(other.bytes_, {});
        }
        return *this;
    }

    std::span<std::byte> bytes() const { return bytes_; }
    explicit operator bool() const { return !bytes_.empty(); }
    void release();

    static constexpr size_t kGrain = size_t{2} << 20; // a large page of x86-64 and ARM [bytes]

private:
    std::span<std::byte> bytes_;
};

} // namespace relume
