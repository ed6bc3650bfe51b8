#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace relume::gltf {

/// A glTF file as bytes and as JSON, its container already checked.
struct File {
    std::string path;           // as given by the user
    std::vector<uint8_t> bytes; // the whole file
    bool binary = false;        // GLB container
    uint64_t chunkBytes = 0;    // size of the GLB's binary chunk, 0: none
    nlohmann::json json;
};

/// Reads a .gltf or .glb file and parses its JSON. Throws Error where the file is missing, truncated, not
/// glTF 2.0, nested too deeply or no JSON.
File readFile(const std::string& path);

} // namespace relume::gltf
