#pragma once

#include <cstdint>
#include <string>

#include "assets/gltf/file/gltf_file.h"

namespace relume::gltf {

/// Names what a scene is made of, each bounded by itself.
enum class Made { Buffers, Vertices, Texels, Names, Triangles };

/// Limits how much a file may make of its bytes: a few of them can name the same vertices, images or meshes
/// any number of times, or vertices that are nowhere. So much is allowed for each byte, and for every file
/// what well-meant small ones need.
class SizeLimit {
public:
    SizeLimit() = default;
    /// Makes a limit; `bytes` is the size of the file and of all that its URIs name.
    SizeLimit(std::string path, uint64_t bytes) : path_(std::move(path)), bytes_(bytes) {}

    /// Throws Error where `amount` is too much; it counts triangles, or bytes of anything else.
    void require(Made made, double amount) const;
    /// Counts decoded pixels [bytes]. Throws Error where all of them together are too much.
    void addTexels(uint64_t bytes);

private:
    std::string path_;
    uint64_t bytes_ = 0;
    double texels_ = 0;
};

/// Throws Error where a checked file (see check) makes too much of its bytes, as far as its JSON tells, and
/// where a buffer's URI names what is no file. Returns the limit for what is only found out later.
SizeLimit checkSizes(const File& file);

/// Returns the path that a URI of this file names, or "" for data that is in the URI.
std::string pathOfUri(const File& file, const std::string& uri);
std::string pathOfUri(const std::string& gltfPath, const std::string& uri);

} // namespace relume::gltf
