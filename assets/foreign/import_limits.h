#pragma once

#include <algorithm>
#include <cstdint>

#include <unistd.h>

namespace relume {

/// Returns three quarters of the machine's memory, or 16 GiB where that is less [bytes].
inline uint64_t usualImportMemory() {
    const auto pages = static_cast<uint64_t>(std::max(sysconf(_SC_PHYS_PAGES), 1L));
    return std::min(pages * static_cast<uint64_t>(sysconf(_SC_PAGESIZE)) / 4 * 3, uint64_t{16} << 30);
}

/// Bounds what a process that converts a file may take.
struct ImportLimits {
    double seconds = 300;                  // on the clock, and of each core
    uint64_t memory = usualImportMemory(); // [bytes], beside what the program itself takes
};

} // namespace relume
