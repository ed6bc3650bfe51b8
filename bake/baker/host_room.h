#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace relume {

/// Returns the memory that programs may still take, by the text of /proc/meminfo [bytes]; nothing where it
/// does not say.
std::optional<uint64_t> availableIn(std::string_view memInfo);
/// Tells what the kernel says of the group of processes that this one is in, such as a container's: texts of
/// the files memory.max, memory.current and memory.stat of its control group, "" where there is none.
struct GroupMemory {
    std::string most, used, statistics;
};
/// Returns what such a group may still take [bytes], files that are only kept in memory counted as free;
/// nothing where it has no limit.
std::optional<uint64_t> availableIn(const GroupMemory& group);
/// Returns what this process may still take on this machine as it is now: its share, where a launcher has
/// started several on it.
std::optional<uint64_t> freeHostMemory();

} // namespace relume
