#pragma once

#include <cctype>
#include <set>
#include <string>
#include <vector>

namespace relume {

/// Tells what is wrong with an HTML or SVG text, or "" where nothing is: tags must be balanced (HTML's empty
/// elements apart), attributes quoted, and `<` and `&` may stand only where they mean markup.
inline std::string markupProblem(const std::string& text) {
    const std::set<std::string> empty = {"meta", "img", "br", "link", "hr"};
    std::vector<std::string> open;
    for (size_t i = 0; i < text.size(); ++i) {
        if (text[i] == '&') {
            const size_t end = text.find(';', i);
            if (end == std::string::npos || end - i > 8) return "a bare & at " + text.substr(i, 20);
        }
        if (text[i] == '>') return "a bare > at " + text.substr(i, 20);
        if (text[i] != '<') continue;
        size_t at = i + 1;
        const bool closes = at < text.size() && text[at] == '/';
        at += closes;
        std::string name;
        while (at < text.size() && (std::isalnum(static_cast<unsigned char>(text[at])) || text[at] == '!'))
            name += text[at++];
        if (name.empty()) return "a bare < at " + text.substr(i, 20);
        bool quoted = false;
        size_t end = at;
        for (; end < text.size() && (quoted || text[end] != '>'); ++end) {
            if (text[end] == '"')
                quoted = !quoted;
            else if (text[end] == '<')
                return "< within a tag at " + text.substr(i, 20);
            else if (text[end] == '=' && !quoted && text[end + 1] != '"')
                return "unquoted: " + text.substr(i, 40);
        }
        if (end >= text.size()) return "an open tag at " + text.substr(i, 20);
        const bool selfClosed = text[end - 1] == '/';
        if (closes) {
            if (open.empty() || open.back() != name) return "</" + name + "> without its start";
            open.pop_back();
        } else if (name[0] != '!' && !selfClosed && empty.count(name) == 0) {
            open.push_back(name);
        }
        if (name == "style" && !closes) { // its text is no markup
            end = text.find("</style>", end);
            if (end == std::string::npos) return "an open <style>";
            --end;
        }
        i = end;
    }
    return open.empty() ? "" : "<" + open.back() + "> is not closed";
}

} // namespace relume
