#include "assets/base/json_text.h"

#include <vector>

namespace relume {

namespace {

using Json = nlohmann::ordered_json;

bool isSpace(char c) {
    return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

/// Returns the JSON as text. Names that a user gave may be no valid UTF-8, which would throw otherwise.
std::string dumped(const Json& value, int step = -1, char indent = ' ') {
    return value.dump(step, indent, false, Json::error_handler_t::replace);
}

/// Holds one member of an object or element of an array, as places in the text; `key` is empty in an array.
struct Item {
    size_t begin = 0;                // of the white space in front of it
    size_t keyBegin = 0, keyEnd = 0; // quotes included
    size_t valueBegin = 0, valueEnd = 0;
    size_t end = 0; // behind the white space after it
};

struct Container {
    std::vector<Item> items;
    size_t closing = 0; // where the closing bracket is
};

/// Walks over a text that is known to be valid JSON.
class Patcher {
public:
    explicit Patcher(std::string_view text) : text_(text) {}

    std::string patch(const Json& before, const Json& after) {
        const size_t begin = skipSpace(0), end = skipValue(begin);
        findUnit(begin);
        std::string out(text_.substr(0, begin));
        value({begin, end}, before, after, out);
        return out += text_.substr(end);
    }

private:
    struct Span {
        size_t begin = 0, end = 0;
    };

    size_t skipSpace(size_t at) const {
        while (at < text_.size() && isSpace(text_[at]))
            ++at;
        return at;
    }
    size_t skipString(size_t at) const { // at its first quote
        for (++at; text_[at] != '"'; ++at)
            if (text_[at] == '\\') ++at;
        return at + 1;
    }
    size_t skipValue(size_t at) const;
    Container items(size_t at) const;
    void findUnit(size_t root);
    std::string indentOf(size_t begin, size_t end) const;
    std::string lineIndent(size_t at) const;
    std::string laidOut(const Json& value, const std::string& indent) const;

    void value(Span span, const Json& before, const Json& after, std::string& out) const;
    bool object(const Container& old, const Json& before, const Json& after, std::string& out) const;
    void array(const Container& old, const Json& before, const Json& after, std::string& out) const;
    void kept(const Item& item, const Json& before, const Json& after, std::string& out) const;
    void added(const Container& old, const std::string* key, const Json& value, std::string& out) const;
    void closed(const Container& old, bool empty, std::string& out) const;

    std::string_view text_;
    std::string unit_; // one step of indentation
    bool lines_ = false;
};

size_t Patcher::skipValue(size_t at) const {
    if (text_[at] == '"') return skipString(at);
    if (text_[at] != '{' && text_[at] != '[') {
        while (at < text_.size() && !isSpace(text_[at]) && text_[at] != ',' && text_[at] != '}' &&
               text_[at] != ']')
            ++at;
        return at;
    }
    for (size_t depth = 0;;) {
        const char c = text_[at];
        if (c == '"') {
            at = skipString(at);
            continue;
        }
        if (c == '{' || c == '[') ++depth;
        ++at;
        if ((c == '}' || c == ']') && --depth == 0) return at;
    }
}

Container Patcher::items(size_t at) const {
    const bool keyed = text_[at] == '{';
    const char bracket = keyed ? '}' : ']';
    Container container;
    container.closing = skipSpace(at + 1);
    if (text_[container.closing] == bracket) return container;
    do {
        Item item;
        item.begin = at + 1;
        item.valueBegin = skipSpace(item.begin);
        if (keyed) {
            item.keyBegin = item.valueBegin;
            item.keyEnd = skipString(item.keyBegin);
            item.valueBegin = skipSpace(skipSpace(item.keyEnd) + 1); // behind the colon
        }
        item.valueEnd = skipValue(item.valueBegin);
        at = item.end = skipSpace(item.valueEnd);
        container.items.push_back(item);
    } while (text_[at] == ',');
    container.closing = at;
    return container;
}

/// Returns the indentation at the end of a stretch of white space, behind its last line break.
std::string Patcher::indentOf(size_t begin, size_t end) const {
    const std::string_view space = text_.substr(begin, end - begin);
    const size_t line = space.rfind('\n');
    return line == std::string_view::npos ? std::string() : std::string(space.substr(line + 1));
}

/// Returns the indentation of the line that a place is in.
std::string Patcher::lineIndent(size_t at) const {
    if (!lines_) return {}; // all of the file may be one line
    const size_t line = text_.rfind('\n', at);
    const size_t begin = line == std::string_view::npos ? 0 : line + 1;
    return std::string(text_.substr(begin, skipSpace(begin) - begin));
}

/// Finds how the file is laid out; its first member shows it.
void Patcher::findUnit(size_t root) {
    if (text_[root] != '{' && text_[root] != '[') return;
    const size_t first = skipSpace(root + 1);
    lines_ = text_.substr(root, first - root).find('\n') != std::string_view::npos;
    unit_ = indentOf(root + 1, first);
}

std::string Patcher::laidOut(const Json& value, const std::string& indent) const {
    if (!lines_) return dumped(value);
    std::string out;
    const int step = static_cast<int>(unit_.size());
    for (const char c : dumped(value, step, unit_.empty() ? ' ' : unit_[0])) {
        out += c;
        if (c == '\n') out += indent;
    }
    return out;
}

void Patcher::value(Span span, const Json& before, const Json& after, std::string& out) const {
    if (before == after) {
        out += text_.substr(span.begin, span.end - span.begin);
        return;
    }
    const size_t size = out.size();
    if (before.type() == after.type() && before.is_structured() && !before.empty() && !after.empty()) {
        const Container old = items(span.begin);
        // There may be fewer in the JSON: then a key stands twice in the text, and places and values do not
        // match.
        if (old.items.size() == before.size()) {
            out += text_[span.begin];
            if (before.is_array()) {
                array(old, before, after, out);
                return;
            }
            if (object(old, before, after, out)) return;
            out.resize(size);
        }
    }
    out += laidOut(after, lineIndent(span.begin));
}

bool Patcher::object(const Container& old, const Json& before, const Json& after, std::string& out) const {
    bool empty = true;
    size_t stays = 0;
    for (const Item& item : old.items) {
        const std::string key = Json::parse(text_.substr(item.keyBegin, item.keyEnd - item.keyBegin));
        const auto from = before.find(key), to = after.find(key);
        if (from == before.end()) return false;
        if (to == after.end()) continue;
        if (!empty) out += ',';
        empty = false;
        ++stays;
        kept(item, *from, *to, out);
    }
    if (stays < after.size())
        for (const auto& [key, value] : after.items()) {
            if (before.contains(key)) continue;
            if (!empty) out += ',';
            empty = false;
            added(old, &key, value, out);
        }
    closed(old, empty, out);
    return true;
}

void Patcher::array(const Container& old, const Json& before, const Json& after, std::string& out) const {
    for (size_t i = 0; i < after.size(); ++i) {
        if (i > 0) out += ',';
        if (i < old.items.size()) {
            kept(old.items[i], before[i], after[i], out);
        } else {
            added(old, nullptr, after[i], out);
        }
    }
    closed(old, after.empty(), out);
}

void Patcher::kept(const Item& item, const Json& before, const Json& after, std::string& out) const {
    out += text_.substr(item.begin, item.valueBegin - item.begin);
    value({item.valueBegin, item.valueEnd}, before, after, out);
    // White space before the bracket belongs to the bracket.
    if (text_[item.end] == ',') out += text_.substr(item.valueEnd, item.end - item.valueEnd);
}

void Patcher::added(const Container& old, const std::string* key, const Json& value, std::string& out) const {
    const Item& last = old.items.back();
    const size_t first = skipSpace(last.begin);
    out += text_.substr(last.begin, first - last.begin);
    if (key) {
        out += dumped(*key);
        out += text_.substr(last.keyEnd, last.valueBegin - last.keyEnd);
    }
    const bool alone = text_.substr(last.begin, first - last.begin).find('\n') != std::string_view::npos;
    out += alone ? laidOut(value, indentOf(last.begin, first)) : dumped(value);
}

void Patcher::closed(const Container& old, bool empty, std::string& out) const {
    if (!empty) out += text_.substr(old.items.back().valueEnd, old.closing - old.items.back().valueEnd);
    out += text_[old.closing];
}

} // namespace

std::string patchJsonText(std::string_view text, const Json& before, const Json& after) {
    return Patcher(text).patch(before, after);
}

} // namespace relume
