#include "assets/foreign/import_messages.h"

#include <algorithm>

namespace relume {
namespace {

// A longer line is no message of ours: the process may be out of hand.
constexpr size_t kLongestLine = 65536; // [bytes]

} // namespace

void ImportMessages::take(std::string_view bytes) {
    for (const char c : bytes) {
        if (c != '\n') {
            if (line_.size() < kLongestLine) line_ += c;
            continue;
        }
        const std::string line = std::exchange(line_, {});
        if (!line.empty()) hear_(static_cast<ImportWord>(line.front()), line.substr(1));
    }
}

std::string importLine(ImportWord word, std::string text) {
    std::replace_if(
        text.begin(), text.end(), [](unsigned char c) { return c < 0x20; }, ' ');
    return static_cast<char>(word) + text.substr(0, kLongestLine - 2) + "\n";
}

} // namespace relume
