#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

namespace relume::gltf {

/// Some exporters leave out as many bytes at the end of a buffer or file: padding, which no element reads.
constexpr uint64_t kPadding = 3;

/// Holds a glTF file as bytes and as JSON; its container is already checked.
struct File {
    std::string path;           // as given by the user
    std::vector<uint8_t> bytes; // the whole file
    bool binary = false;        // GLB container
    uint64_t jsonBegin = 0;     // where the JSON text begins in bytes
    uint64_t jsonBytes = 0;     // its size, a GLB's padding included
    uint64_t chunkBegin = 0;    // where the GLB's binary chunk's data begins in bytes
    uint64_t chunkBytes = 0;    // size of the GLB's binary chunk, 0: none
    bool isShort = false;       // a few bytes at the end were missing, and are zeros here
    nlohmann::json json;
};

/// Reads a .gltf or .glb file and parses its JSON. Throws Error where the file is missing, truncated, not
/// glTF 2.0, nested too deeply or no JSON.
File readFile(const std::string& path);

/// Tells whether the path names a GLB file that has at least the bytes that its header promises: whoever
/// writes it is done. False where it cannot be read.
bool isWholeGlb(const std::string& path);

/// Returns how many bytes the buffer that lies in a GLB's binary chunk has by a checked file's JSON; 0 for
/// none.
uint64_t chunkBytesOf(const nlohmann::json& json);

/// Returns the file's bytes with another JSON text in place of its own, in the same container; of a GLB's
/// chunks, only those that the parser wants are kept.
std::vector<uint8_t> withJson(const File& file, const nlohmann::json& json);

/// Returns the member `key` of extras.relume, where files hold what glTF has no word for, or nullptr where
/// there is none.
const nlohmann::json* ownExtra(const nlohmann::json& holder, const char* key);

/// Returns the file's JSON text, which lives as long as the file's bytes.
std::string_view jsonText(const File& file);

/// Returns the file's bytes with another JSON text in place of its own; all else stays as it was, to the
/// byte. Throws Error where it gets too large.
std::string withJsonText(const File& file, std::string_view text);

} // namespace relume::gltf
