#include "tests/unit/class_sizes.h"

#include <algorithm>
#include <regex>
#include <set>

namespace relume {
namespace {

std::string without(const std::string& text, const std::regex& pattern, const char* instead = "") {
    return std::regex_replace(text, pattern, instead);
}

// Takes comments, literals and preprocessor lines out, as braces and commas in them mean nothing. This is a
// loop, for std::regex recurses with the length of what it matches.
std::string bare(const std::string& source) {
    std::string text;
    for (size_t i = 0; i < source.size(); ++i) {
        const char c = source[i];
        const bool lineStarts = i == 0 || source[i - 1] == '\n';
        const bool digits = i > 0 && std::isalnum(static_cast<unsigned char>(source[i - 1])) != 0;
        if (source.compare(i, 2, "//") == 0 || (c == '#' && lineStarts)) {
            while (i + 1 < source.size() && source[i + 1] != '\n')
                ++i;
        } else if (c == '"' || (c == '\'' && !digits)) {
            for (++i; i < source.size() && source[i] != c; ++i)
                if (source[i] == '\\') ++i;
            text += "0";
        } else {
            text += c;
        }
    }
    return text;
}

// Returns the place behind the brace that closes the one at `open`.
size_t behindBraces(const std::string& text, size_t open) {
    int depth = 0;
    for (size_t i = open; i < text.size(); ++i) {
        depth += text[i] == '{' ? 1 : text[i] == '}' ? -1 : 0;
        if (depth == 0) return i + 1;
    }
    return text.size();
}

std::string withoutTemplates(std::string text) {
    static const std::regex kInnermost("<[^<>]*>");
    for (std::string before; before != text;) {
        before = text;
        text = without(text, kInnermost);
    }
    return text;
}

// Tells whether what stands before a brace begins the body of a function.
bool isFunctionHead(const std::string& head) {
    const std::string plain = withoutTemplates(head);
    const size_t call = plain.find('(');
    return call != std::string::npos && plain.substr(0, call).find('=') == std::string::npos;
}

void countDeclaration(const std::string& text, ClassSize& size) {
    static const std::regex kAccess("\\b(public|private|protected)\\s*:"), kSpace("\\s+"), kEnds("^ | $");
    static const std::regex kConstant("^(inline )?static constexpr"), kParentheses("\\([^()]*\\)");
    static const std::regex kNothing("(using|friend|typedef|static_assert|enum)\\b.*|(class|struct)\\s+\\w+");
    const std::string line = without(without(without(text, kAccess), kSpace, " "), kEnds);
    if (line.empty() || line == "@" || std::regex_match(line, kNothing)) return;
    const std::string plain = withoutTemplates(line);
    const std::string declared = plain.substr(0, plain.find('='));
    if (declared.find('(') != std::string::npos || plain.find("operator") != std::string::npos) {
        ++size.functions;
    } else if (!std::regex_search(plain, kConstant)) {
        const std::string names = without(plain, kParentheses);
        size.data += 1 + static_cast<size_t>(std::count(names.begin(), names.end(), ','));
    }
}

// A nested type counts by itself: in its place stands @, before which a declarator may follow.
ClassSize sizeOf(const std::string& name, const std::string& body) {
    static const std::regex kType("\\b(class|struct|enum|union)\\b[^(=]*$");
    ClassSize size{name};
    std::string head;
    int depth = 0;
    for (size_t i = 0; i < body.size(); ++i) {
        const char c = body[i];
        depth += c == '(' ? 1 : c == ')' ? -1 : 0;
        if (c == '{' && depth == 0) {
            const size_t end = behindBraces(body, i);
            const size_t next = body.find_first_not_of(" \n\t", end);
            const bool more = next != std::string::npos && (body[next] == ',' || body[next] == '{');
            if (std::regex_search(head, kType)) {
                head = "@";
            } else if (isFunctionHead(head) && !more) { // else more of a constructor's initializers
                ++size.functions;
                head.clear();
            }
            i = end - 1;
        } else if (c == ';' && depth == 0) {
            countDeclaration(head, size);
            head.clear();
        } else {
            head += c;
        }
    }
    return size;
}

} // namespace

std::vector<ClassSize> classSizes(const std::string& source) {
    const std::string text = bare(source);
    static const std::regex kDefinition("\\b(class|struct)\\s+(\\w+)(\\s+final)?(\\s*:[^;{(]*)?\\s*\\{");
    std::vector<ClassSize> sizes;
    for (std::sregex_iterator it(text.begin(), text.end(), kDefinition), end; it != end; ++it) {
        const auto first = static_cast<size_t>(it->position());
        if (first >= 5 && text.compare(first - 5, 5, "enum ") == 0) continue;
        const auto open = first + static_cast<size_t>(it->length()) - 1;
        const size_t close = behindBraces(text, open) - 1;
        sizes.push_back(sizeOf((*it)[2], text.substr(open + 1, close - open - 1)));
    }
    return sizes;
}

std::vector<std::string> classesImplementedIn(const std::string& source) {
    static const std::regex kFunction("(^|\\n)[A-Za-z][^\\n;={]*\\b(\\w+)::~?\\w+\\(");
    static const std::regex kConstructor("(^|\\n)(\\w+)::~?\\w+\\(");
    const std::string text = bare(source);
    std::set<std::string> names;
    for (const std::regex* pattern : {&kFunction, &kConstructor})
        for (std::sregex_iterator it(text.begin(), text.end(), *pattern), end; it != end; ++it)
            names.insert((*it)[2]);
    return {names.begin(), names.end()};
}

} // namespace relume
