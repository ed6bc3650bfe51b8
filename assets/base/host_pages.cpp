#include "assets/base/host_pages.h"

#include <cstdint>

#include <sys/mman.h>

#include "assets/base/error.h"

namespace relume {
namespace {

constexpr size_t kSmallPage = 4096;

} // namespace

HostPages::HostPages(WorkerPool& pool, size_t bytes) {
    ASSERT(bytes > 0 && bytes % kGrain == 0);
    void* const memory =
        mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (memory == MAP_FAILED) return;
    bytes_ = {static_cast<std::byte*>(memory), bytes};
    madvise(memory, bytes, MADV_HUGEPAGE); // where the system has none to give, small ones come
    pool.run(static_cast<uint32_t>(bytes / kGrain), [&](uint32_t grain) {
        for (size_t at = grain * kGrain; at < (grain + 1) * kGrain; at += kSmallPage)
            *static_cast<volatile std::byte*>(bytes_.data() + at) = std::byte{0};
    });
}

void HostPages::release() {
    if (!bytes_.empty()) munmap(bytes_.data(), bytes_.size());
    bytes_ = {};
}

} // namespace relume
