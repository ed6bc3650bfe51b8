#include "assets/foreign/named_files.h"

#include "assets/foreign/foreign_files.h"
#include "assets/foreign/near_files.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <set>
#include <string_view>
#include <system_error>

namespace relume {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 22> kNamedEndings = {
    ".mtl", ".png",  ".jpg", ".jpeg", ".tga", ".bmp", ".gif",  ".psd", ".pnm", ".ppm", ".pgm",
    ".pic", ".webp", ".tif", ".tiff", ".dds", ".hdr", ".ktx2", ".ktx", ".exr", ".lwo", ".material"};
constexpr size_t kLongestEnding = 9;      // [bytes]
constexpr size_t kLongestName = 1024;     // [bytes], with its folders
constexpr size_t kMostNamesInFile = 4000; // in one file, each of which is looked for on the disk
constexpr size_t kMostWords = 12;         // of a name, as spaces may be a part of it or stand before it
constexpr size_t kPiece = 1 << 20;        // [bytes], read at once

bool endsName(char c) {
    return static_cast<unsigned char>(c) < 0x20 || c == '"' || c == '<' || c == '>' || c == '|' || c == '*';
}

// Returns the length of the longest ending that stands at the beginning of this text, or 0.
size_t endingLength(std::string_view text) {
    size_t longest = 0;
    // Nearly all dots of a large file are those of numbers.
    if (text.size() < 2 || std::isalpha(static_cast<unsigned char>(text[1])) == 0) return 0;
    for (const std::string_view ending : kNamedEndings) {
        if (text.size() < ending.size() || ending.size() <= longest) continue;
        const bool same = std::equal(ending.begin(), ending.end(), text.begin(), [](char a, char b) {
            return a == static_cast<char>(std::tolower(static_cast<unsigned char>(b)));
        });
        if (same) longest = ending.size();
    }
    return longest;
}

using TakeName = std::function<void(std::string_view)>;

// Calls back with each text that ends as a file does, from the last character before it that no name has.
void findNames(std::string_view bytes, size_t begin, size_t end, const TakeName& take) {
    const auto nextDot = [&](size_t at) {
        const void* found = at < end ? std::memchr(bytes.data() + at, '.', end - at) : nullptr;
        return found ? static_cast<size_t>(static_cast<const char*>(found) - bytes.data()) : end;
    };
    for (size_t dot = nextDot(begin); dot < end; dot = nextDot(dot + 1)) {
        const size_t length = endingLength(bytes.substr(dot));
        if (length == 0) continue;
        size_t first = dot;
        while (first > 0 && dot - first < kLongestName && !endsName(bytes[first - 1]))
            --first;
        take(bytes.substr(first, dot + length - first));
    }
}

void findNamesInFile(const std::string& path, const TakeName& take) {
    std::error_code code;
    if (!fs::is_regular_file(path, code)) return;
    std::ifstream stream(path, std::ios::binary);
    std::string bytes;
    size_t begin = 0; // of what was not looked at yet
    while (stream) {
        const size_t kept = bytes.size();
        bytes.resize(kept + kPiece);
        stream.read(bytes.data() + kept, kPiece);
        bytes.resize(kept + static_cast<size_t>(std::max<std::streamsize>(stream.gcount(), 0)));
        // An ending may go on in the next piece, and a name may have begun in this one.
        const size_t end = stream ? bytes.size() - std::min(bytes.size(), kLongestEnding) : bytes.size();
        findNames(bytes, begin, end, take);
        const size_t past = end - std::min(end, kLongestName);
        bytes.erase(0, past);
        begin = end - past;
    }
}

/// Collects the files that texts name.
class Collector {
public:
    explicit Collector(const std::string& model) : near_(model) {}

    // Takes the longest part of a text that names a file: from its beginning, or from one of its words on.
    void take(std::string_view text, std::vector<std::string>& found) {
        if (texts_.size() >= kMostNamesInFile || !texts_.emplace(text).second) return;
        size_t first = 0;
        for (size_t words = 0; words < kMostWords && first < text.size(); ++words) {
            if (const std::string file = near_.find(std::string(text.substr(first))); !file.empty()) {
                if (files_.insert(file).second) found.push_back(file);
                return;
            }
            const size_t gap = text.find_first_of(" =,('", first);
            if (gap == std::string_view::npos) return;
            first = gap + 1;
        }
    }

private:
    NearFiles near_;
    std::set<std::string, std::less<>> texts_;
    std::set<std::string> files_;
};

} // namespace

std::vector<std::string> namedFiles(const std::string& path) {
    std::vector<std::string> files;
    Collector collector(path);
    const auto take = [&](std::string_view text) { collector.take(text, files); };
    findNamesInFile(path, take);
    // A library that is missing is looked for under the model's own name.
    if (lowerEnding(path) == ".obj") take(fs::path(path).stem().string() + ".mtl");
    for (size_t i = 0; i < files.size(); ++i)
        if (const std::string ending = lowerEnding(files[i]); ending == ".mtl" || ending == ".material")
            findNamesInFile(std::string(files[i]), take);
    return files;
}

} // namespace relume
