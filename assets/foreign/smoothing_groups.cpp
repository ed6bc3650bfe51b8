#include "assets/foreign/smoothing_groups.h"

#include "assets/foreign/foreign_files.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string_view>

namespace relume {
namespace {

// Chunks of .3ds files. Each has its kind, its length with these six bytes, and what it holds.
constexpr uint16_t kMain = 0x4d4d, kEditor = 0x3d3d, kObject = 0x4000, kMesh = 0x4100, kFaces = 0x4120,
                   kGroups = 0x4150;
constexpr size_t kHead = 6, kFace = 8; // [bytes]

std::string bytesOf(const std::string& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

template<typename T>
T numberAt(std::string_view bytes, size_t at) {
    T number{};
    std::memcpy(&number, bytes.data() + at, sizeof(T)); // both are little-endian
    return number;
}

// Returns how much stands before the chunks within a chunk of this kind.
size_t ownBytes(uint16_t kind, std::string_view content) {
    if (kind == kObject) return std::min(content.find('\0'), content.size() - 1) + 1; // its name
    if (kind == kFaces && content.size() >= 2) return 2 + kFace * numberAt<uint16_t>(content, 0);
    return 0;
}

bool hasGroups3ds(std::string_view chunks, int deepest = 6) {
    while (chunks.size() > kHead) {
        const auto kind = numberAt<uint16_t>(chunks, 0);
        const size_t length = numberAt<uint32_t>(chunks, 2);
        if (length < kHead) return false;
        const std::string_view content = chunks.substr(kHead, length - kHead);
        if (kind == kGroups && std::any_of(content.begin(), content.end(), [](char c) { return c != 0; }))
            return true;
        if (kind == kMain || kind == kEditor || kind == kObject || kind == kMesh || kind == kFaces) {
            const size_t own = content.empty() ? 0 : ownBytes(kind, content);
            if (deepest > 1 && own < content.size() && hasGroups3ds(content.substr(own), deepest - 1))
                return true;
        }
        chunks.remove_prefix(std::min(length, chunks.size()));
    }
    return false;
}

bool hasGroupsAse(std::string_view text) {
    constexpr std::string_view kWord = "*MESH_SMOOTHING";
    for (size_t at = text.find(kWord); at != std::string_view::npos; at = text.find(kWord, at)) {
        at += kWord.size();
        const size_t group = std::min(text.find_first_not_of(" \t", at), text.size());
        if (group < text.size() && text[group] >= '1' && text[group] <= '9') return true;
    }
    return text.find("*MESH_NORMALS") != std::string_view::npos; // which are read as they are
}

} // namespace

bool meansItsNormals(const std::string& path) {
    const std::string ending = lowerEnding(path);
    if (ending == ".3ds") return hasGroups3ds(bytesOf(path));
    if (ending == ".ase") return hasGroupsAse(bytesOf(path));
    return ending != ".blend";
}

} // namespace relume
