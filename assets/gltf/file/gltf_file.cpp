#include "assets/gltf/file/gltf_file.h"

#include "assets/base/error.h"
#include "assets/base/file_read.h"
#include "assets/base/warnings.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cctype>
#include <cstring>
#include <limits>

namespace relume::gltf {

namespace {

constexpr uint32_t kMagic = 0x46546c67, kJsonChunk = 0x4e4f534a, kBinChunk = 0x004e4942;
constexpr size_t kHeaderBytes = 12, kChunkHeaderBytes = 8;
constexpr int kMaxDepth =
    64; // glTF's own structures need 9 levels; both parsers recurse over extras and extensions

uint32_t readU32(const std::vector<uint8_t>& bytes, size_t offset) {
    uint32_t value;
    std::memcpy(&value, bytes.data() + offset, sizeof(value));
    return value;
}

std::vector<uint8_t> readBytes(const std::string& path) {
    RegularFile file(path, "name a .gltf or .glb file");
    if (file.size() > std::numeric_limits<uint32_t>::max())
        throw Error(fmt::format("{}: is larger than 4 GiB, which glTF cannot hold: split the scene", path));
    std::vector<uint8_t> bytes(file.size());
    file.read(bytes.data(), bytes.size());
    return bytes;
}

[[noreturn]] void throwDamaged(const std::string& path, const std::string& what) {
    throw Error(fmt::format("{}: {}: the file is damaged, export or download it again", path, what));
}

/// Checks the chunks of a GLB and returns the JSON text's range in its bytes.
std::pair<size_t, size_t> checkContainer(File& file) {
    std::vector<uint8_t>& bytes = file.bytes;
    if (bytes.size() < kHeaderBytes + kChunkHeaderBytes)
        throwDamaged(file.path, "ends inside the GLB header");
    const uint32_t version = readU32(bytes, 4), length = readU32(bytes, 8);
    if (version != 2)
        throw Error(fmt::format("{}: is GLB version {}, only 2 is supported: export it as glTF 2.0",
                                file.path, version));
    if (length > bytes.size() + kPadding)
        throwDamaged(file.path, fmt::format("is truncated: the header says {} bytes, the file has {}", length,
                                            bytes.size()));
    const size_t held = bytes.size();
    file.isShort = length > held;
    if (file.isShort) bytes.resize(length);
    const size_t jsonBytes = readU32(bytes, kHeaderBytes);
    if (readU32(bytes, kHeaderBytes + 4) != kJsonChunk)
        throwDamaged(file.path, "the first GLB chunk is not JSON");
    const size_t jsonBegin = kHeaderBytes + kChunkHeaderBytes, jsonEnd = jsonBegin + jsonBytes;
    if (jsonEnd > length) throwDamaged(file.path, "is truncated inside the JSON chunk");
    if (jsonEnd == length) {
        for (size_t i = held; i < length; ++i)
            bytes[i] = ' '; // JSON is padded by blanks
        return {jsonBegin, jsonEnd};
    }
    if (jsonEnd + kChunkHeaderBytes > length) throwDamaged(file.path, "is truncated behind the JSON chunk");
    const size_t chunkBegin = jsonEnd + kChunkHeaderBytes, chunkBytes = readU32(bytes, jsonEnd);
    if (chunkBegin + chunkBytes > length + kPadding)
        throwDamaged(file.path, "is truncated inside the binary chunk");
    if (chunkBegin + chunkBytes > bytes.size()) {
        file.isShort = true;
        bytes.resize(chunkBegin + chunkBytes);
    }
    if (readU32(bytes, jsonEnd + 4) == kBinChunk) {
        file.chunkBegin = chunkBegin;
        file.chunkBytes = chunkBytes;
    }
    return {jsonBegin, jsonEnd};
}

int nestingDepth(const char* begin, const char* end) {
    int depth = 0, deepest = 0;
    bool inString = false;
    for (const char* c = begin; c != end; ++c) {
        if (inString) {
            if (*c == '\\' && c + 1 != end) {
                ++c;
            } else if (*c == '"') {
                inString = false;
            }
        } else if (*c == '"') {
            inString = true;
        } else if (*c == '{' || *c == '[') {
            deepest = std::max(deepest, ++depth);
        } else if (*c == '}' || *c == ']') {
            --depth;
        }
    }
    return deepest;
}

} // namespace

bool isWholeGlb(const std::string& path) {
    std::vector<uint8_t> header(kHeaderBytes);
    try {
        RegularFile file(path, "");
        if (file.size() < header.size()) return false;
        file.read(header.data(), header.size());
        return readU32(header, 0) == kMagic && readU32(header, 8) <= file.size();
    } catch (const Error&) {
        return false;
    }
}

File readFile(const std::string& path) {
    File file;
    file.path = path;
    file.bytes = readBytes(path);
    if (file.bytes.empty()) throw Error(fmt::format("{}: is empty: export it again", path));
    file.binary = file.bytes.size() >= 4 && readU32(file.bytes, 0) == kMagic;
    size_t begin = 0, end = file.bytes.size();
    if (file.binary) {
        std::tie(begin, end) = checkContainer(file);
    } else {
        // Only white space or a byte order mark may stand before a JSON object.
        constexpr uint8_t kByteOrderMark[] = {0xef, 0xbb, 0xbf};
        if (end >= 3 && std::equal(kByteOrderMark, kByteOrderMark + 3, file.bytes.begin())) begin = 3;
        size_t first = begin;
        while (first < end && std::isspace(file.bytes[first]))
            ++first;
        if (first == end || file.bytes[first] != '{')
            throw Error(fmt::format(
                "{}: is neither a GLB (wrong magic) nor a glTF JSON file: give a glTF 2.0 file", path));
    }
    file.jsonBegin = begin;
    file.jsonBytes = end - begin;
    const char* text = reinterpret_cast<const char*>(file.bytes.data());
    if (nestingDepth(text + begin, text + end) > kMaxDepth)
        throw Error(fmt::format("{}: its JSON is nested more than {} deep: export it without such extras",
                                path, kMaxDepth));
    try {
        file.json = nlohmann::json::parse(text + begin, text + end);
    } catch (const nlohmann::json::exception& error) {
        throwDamaged(path, "is no valid JSON (" + inQuotes(error.what()) + ")");
    }
    if (!file.json.is_object()) throwDamaged(path, "its JSON is not an object");
    return file;
}

uint64_t chunkBytesOf(const nlohmann::json& root) {
    const auto buffers = root.find("buffers");
    if (buffers == root.end() || buffers->empty() || buffers->front().contains("uri")) return 0;
    return buffers->front()["byteLength"].get<uint64_t>();
}

std::vector<uint8_t> withJson(const File& file, const nlohmann::json& root) {
    std::string text = root.dump();
    if (!file.binary) return {text.begin(), text.end()};
    while (text.size() % 4 != 0)
        text += ' ';
    // The parser wants whole words of data, but some exporters do not pad it.
    const uint64_t wanted = file.chunkBytes > 0 ? std::max(file.chunkBytes, chunkBytesOf(root)) : 0;
    const uint64_t chunkBytes = (wanted + 3) / 4 * 4;
    uint64_t length = kHeaderBytes + kChunkHeaderBytes + text.size();
    if (chunkBytes > 0) length += kChunkHeaderBytes + chunkBytes;
    if (length > std::numeric_limits<uint32_t>::max())
        throw Error(
            fmt::format("{}: is larger than 4 GiB, which glTF cannot hold: split the scene", file.path));
    std::vector<uint8_t> bytes;
    bytes.reserve(length);
    const auto word = [&bytes](uint64_t value) {
        for (int i = 0; i < 4; ++i)
            bytes.push_back(static_cast<uint8_t>(value >> (8 * i)));
    };
    for (uint64_t value :
         {uint64_t(kMagic), uint64_t(2), length, uint64_t(text.size()), uint64_t(kJsonChunk)})
        word(value);
    bytes.insert(bytes.end(), text.begin(), text.end());
    if (chunkBytes == 0) return bytes;
    word(chunkBytes);
    word(kBinChunk);
    const auto chunk = file.bytes.begin() + static_cast<std::ptrdiff_t>(file.chunkBegin);
    bytes.insert(bytes.end(), chunk, chunk + static_cast<std::ptrdiff_t>(file.chunkBytes));
    bytes.resize(length);
    return bytes;
}

const nlohmann::json* ownExtra(const nlohmann::json& holder, const char* key) {
    const nlohmann::json* value = &holder;
    for (const char* step : {"extras", "relume", key}) {
        if (!value->is_object()) return nullptr;
        const auto found = value->find(step);
        if (found == value->end()) return nullptr;
        value = &*found;
    }
    return value;
}

std::string_view jsonText(const File& file) {
    return {reinterpret_cast<const char*>(file.bytes.data()) + file.jsonBegin, file.jsonBytes};
}

std::string withJsonText(const File& file, std::string_view text) {
    const std::string_view bytes(reinterpret_cast<const char*>(file.bytes.data()), file.bytes.size());
    std::string out(bytes.substr(0, file.jsonBegin));
    out += text;
    if (file.binary) {
        if (text != jsonText(file)) out.append((4 - out.size() % 4) % 4, ' ');
        const uint64_t length = readU32(file.bytes, 8) - file.jsonBytes + (out.size() - file.jsonBegin);
        if (length > std::numeric_limits<uint32_t>::max())
            throw Error(
                fmt::format("{}: is larger than 4 GiB, which glTF cannot hold: split the scene", file.path));
        const auto put = [&out](size_t offset, uint64_t value) {
            for (size_t i = 0; i < 4; ++i)
                out[offset + i] = static_cast<char>(value >> (8 * i));
        };
        put(8, length);
        put(kHeaderBytes, out.size() - file.jsonBegin);
    }
    return out += bytes.substr(file.jsonBegin + file.jsonBytes);
}

} // namespace relume::gltf
