#include <cstdint>
#include <fstream>
#include <new>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace relume {
namespace {

// Returns what the kernel tells of the mapping that has an address: flags of two letters, "" where it has
// none.
std::string flagsAt(const void* address) {
    const auto place = reinterpret_cast<uintptr_t>(address);
    std::ifstream maps("/proc/self/smaps");
    bool here = false;
    for (std::string line; std::getline(maps, line);) {
        unsigned long long first = 0, end = 0;
        char dash = 0;
        std::istringstream range(line);
        if (range >> std::hex >> first >> dash >> end && dash == '-') here = first <= place && place < end;
        if (here && line.starts_with("VmFlags:")) return line.substr(8);
    }
    return "";
}

TEST(LargeBlocks, LieInHugePages) {
    if (!std::ifstream("/sys/kernel/mm/transparent_hugepage/enabled"))
        GTEST_SKIP() << "this kernel has no transparent huge pages";
    constexpr size_t kLarge = size_t{64} << 20;
    const std::vector<char> large(kLarge, 1);
    if (flagsAt(large.data()).empty()) GTEST_SKIP() << "this kernel does not tell what was asked for";
    for (const size_t at : {size_t{0}, kLarge / 2, kLarge - 1})
        EXPECT_NE(flagsAt(&large[at]).find(" hg"), std::string::npos) << at << ":" << flagsAt(&large[at]);
    EXPECT_EQ(large.front() + large.back(), 2);
}

TEST(LargeBlocks, AreRefusedBeyondAllMemory) {
    for (const size_t size : {size_t{1} << 47, size_t{1} << 62})
        EXPECT_THROW(::operator delete(::operator new(size)), std::bad_alloc) << size;
}

TEST(LargeBlocks, SmallOnesAreAsBefore) {
    for (const size_t size : {size_t{0}, size_t{1}, size_t{4096}, size_t{3} << 20, (size_t{8} << 20) + 1}) {
        void* const block = ::operator new(size);
        ASSERT_NE(block, nullptr) << size;
        if (size > 0) static_cast<char*>(block)[size - 1] = 1;
        ::operator delete(block, size);
    }
}

} // namespace
} // namespace relume
