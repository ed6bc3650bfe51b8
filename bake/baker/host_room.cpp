#include "bake/baker/host_room.h"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <iterator>

#include "bake/ranks/launch.h"

namespace relume {
namespace {

// Returns the number that a text begins with; nothing where it does not begin with one.
std::optional<uint64_t> numberAtStart(std::string_view text) {
    uint64_t number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc()) return std::nullopt;
    return number;
}

// Returns the text behind a name at the start of a line, without the spaces between them.
std::optional<std::string_view> valueOf(std::string_view text, std::string_view name) {
    for (size_t at = text.find(name); at != std::string_view::npos; at = text.find(name, at + 1)) {
        if (at > 0 && text[at - 1] != '\n') continue;
        at = text.find_first_not_of(' ', at + name.size());
        return at == std::string_view::npos ? std::string_view() : text.substr(at);
    }
    return std::nullopt;
}

// Returns the text of a file, "" where it cannot be read.
std::string textOf(const std::string& path) {
    std::ifstream file(path);
    return {std::istreambuf_iterator<char>(file), {}};
}

// Returns what the kernel says of this process' group, in the second version of control groups or the first.
GroupMemory groupOfProcess() {
    const std::string second = "/sys/fs/cgroup/", first = "/sys/fs/cgroup/memory/";
    GroupMemory group{textOf(second + "memory.max"), textOf(second + "memory.current"),
                      textOf(second + "memory.stat")};
    if (!group.most.empty()) return group;
    return {textOf(first + "memory.limit_in_bytes"), textOf(first + "memory.usage_in_bytes"),
            textOf(first + "memory.stat")};
}

} // namespace

std::optional<uint64_t> availableIn(std::string_view memInfo) {
    const std::optional<std::string_view> value = valueOf(memInfo, "MemAvailable:");
    const std::optional<uint64_t> kibibytes = value ? numberAtStart(*value) : std::nullopt;
    if (!kibibytes) return std::nullopt;
    const size_t unit = std::min(value->size(), value->find_first_not_of("0123456789"));
    if (!value->substr(unit).starts_with(" kB")) return std::nullopt;
    return *kibibytes << 10;
}

std::optional<uint64_t> availableIn(const GroupMemory& group) {
    const std::optional<uint64_t> most = numberAtStart(group.most), used = numberAtStart(group.used);
    if (!most || !used) return std::nullopt;
    const std::optional<std::string_view> kept = valueOf(group.statistics, "inactive_file ");
    const uint64_t files = kept ? numberAtStart(*kept).value_or(0) : 0;
    const uint64_t taken = *used - std::min(*used, files);
    return *most - std::min(*most, taken);
}

std::optional<uint64_t> freeHostMemory() {
    std::optional<uint64_t> free = availableIn(textOf("/proc/meminfo"));
    if (const std::optional<uint64_t> group = availableIn(groupOfProcess()))
        free = std::min(free.value_or(*group), *group);
    if (free) *free /= std::max(1u, launchOfProcess().localCount);
    return free;
}

} // namespace relume
