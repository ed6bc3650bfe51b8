#include "assets/base/warnings.h"

#include <spdlog/fmt/fmt.h>

namespace relume {

void Warnings::add(const std::string& thing, const std::string& problem) {
    for (Entry& entry : entries_) {
        if (entry.problem != problem) continue;
        if (entry.last != thing) ++entry.count;
        entry.last = thing;
        return;
    }
    entries_.push_back({thing, thing, problem});
}

std::vector<std::string> Warnings::lines(const std::string& path) const {
    std::vector<std::string> lines;
    for (const Entry& entry : entries_) {
        std::string line = path.empty() ? entry.first : path + ": " + entry.first;
        if (entry.count > 1) line += fmt::format(" and {} more", entry.count - 1);
        lines.push_back(line + ": " + entry.problem);
    }
    return lines;
}

std::string inQuotes(const std::string& name) {
    constexpr size_t kLongest = 80; // characters; a data URI in a message helps nobody
    size_t length = name.size();
    if (length > kLongest) {
        length = kLongest;
        while (length > 0 && (static_cast<unsigned char>(name[length]) & 0xc0) == 0x80)
            --length; // whole characters
    }
    std::string clean = "'";
    for (size_t i = 0; i < length; ++i)
        clean += static_cast<unsigned char>(name[i]) < 0x20 ? ' ' : name[i];
    return clean + (length < name.size() ? "...'" : "'");
}

} // namespace relume
