#pragma once

#include <cstdint>
#include <fstream>
#include <functional>
#include <string>

#include <sys/wait.h>
#include <unistd.h>

namespace relume::test {

constexpr int64_t kLittleMemory = 100 << 20; // [bytes]; the sanitizers' own included

/// Returns a line of /proc/self/status [bytes], such as "VmHWM", the most memory that was in use.
inline uint64_t memoryStatus(const std::string& name) {
    std::ifstream status("/proc/self/status");
    uint64_t kib = 0;
    for (std::string line; std::getline(status, line);)
        if (line.starts_with(name + ":")) kib = std::stoull(line.substr(name.size() + 1));
    return kib << 10;
}

/// Returns by how much `action` raises the memory in use at its peak [bytes], in a process of its own; -1
/// where that does not end well.
inline int64_t peakGrowth(const std::function<void()>& action) {
    int ends[2];
    if (pipe(ends) != 0) return -1;
    const pid_t child = fork();
    if (child < 0) return -1;
    if (child == 0) {
        int64_t grown = -1;
        try {
            const uint64_t before = memoryStatus("VmRSS");
            action();
            grown = static_cast<int64_t>(memoryStatus("VmHWM")) - static_cast<int64_t>(before);
        } catch (...) { // tells -1
        }
        const bool told = write(ends[1], &grown, sizeof(grown)) == sizeof(grown);
        _exit(told ? 0 : 1);
    }
    close(ends[1]);
    int64_t grown = -1;
    if (read(ends[0], &grown, sizeof(grown)) != sizeof(grown)) grown = -1;
    close(ends[0]);
    int status = 0;
    waitpid(child, &status, 0);
    return grown;
}

} // namespace relume::test
