// Large blocks of memory come in huge pages. The arrays of a large lightmap take gigabytes, and a kernel that
// gives them out in pages of 4 KiB takes longer to do so than it takes to fill them. Huge pages are asked
// for, as most distributions give them to nobody else (/sys/kernel/mm/transparent_hugepage/enabled: madvise);
// where there are none nothing changes.
//
// These replace the operators that all containers get their memory from ([new.delete.single]). The other
// forms of new and delete, but those for aligned types, call these.
#include <cstdlib>
#include <new>

#include <sys/mman.h>

namespace {

constexpr std::size_t kHugePage = std::size_t{2} << 20; // x86-64; elsewhere the advice may not be taken
constexpr std::size_t kLarge = 2 * kHugePage;           // below, the ends weigh too much

void* largeBlock(std::size_t size) {
    const std::size_t pages = size / kHugePage * kHugePage; // no memory is taken for what is behind the end
    void* const block = std::aligned_alloc(kHugePage, (size + kHugePage - 1) / kHugePage * kHugePage);
    if (block != nullptr) madvise(block, pages, MADV_HUGEPAGE); // advice: it may fail
    return block;
}

void* anyBlock(std::size_t size) {
    constexpr std::size_t kMost = std::size_t{1} << 47; // and the sum above does not overflow
    if (size >= kMost) return nullptr;
    return size >= kLarge ? largeBlock(size) : std::malloc(size > 0 ? size : 1);
}

} // namespace

void* operator new(std::size_t size) {
    for (;;) {
        if (void* const block = anyBlock(size)) return block;
        const std::new_handler handler = std::get_new_handler();
        if (handler == nullptr) throw std::bad_alloc();
        handler();
    }
}

void operator delete(void* block) noexcept {
    std::free(block);
}

void operator delete(void* block, std::size_t) noexcept {
    std::free(block);
}
