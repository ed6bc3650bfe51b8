#include "app/offline/name_lines.h"

#include <utility>

namespace relume {

std::string linesOf(const std::vector<std::string>& names) {
    std::string text;
    for (const std::string& name : names) {
        for (const char c : name)
            text += c == '\n' ? "\\n" : c == '\\' ? "\\\\" : std::string(1, c);
        text += '\n';
    }
    return text;
}

std::string joinedLines(const std::vector<std::string>& names) {
    std::string text = linesOf(names);
    if (!text.empty()) text.pop_back();
    return text;
}

std::vector<std::string> namesIn(const std::string& lines) {
    std::vector<std::string> names;
    std::string name;
    for (size_t i = 0; i < lines.size(); ++i) {
        if (lines[i] == '\n') {
            names.push_back(std::move(name));
            name.clear();
        } else if (lines[i] == '\\' && i + 1 < lines.size()) {
            name += lines[++i] == 'n' ? '\n' : lines[i];
        } else {
            name += lines[i];
        }
    }
    if (!name.empty()) names.push_back(std::move(name));
    return names;
}

} // namespace relume
