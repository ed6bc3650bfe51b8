#pragma once

#include <string>
#include <vector>

#include "assets/gltf/file/gltf_file.h"

namespace relume::gltf {

/// Checks a file's JSON before anything is built from it: version, required extensions, the types and ranges
/// of all indices, the extents of buffer views and accessors, each node's single parent. Throws Error naming
/// the first fault. After it every index into buffers, views, accessors, materials, textures, images and
/// nodes may be trusted; what skins and animations name may not.
void check(const File& file);

/// Returns the extensions that a file uses or requires and Relume does not know, each once.
std::vector<std::string> unknownExtensions(const File& file);

/// Return the bytes of one component (5121 ...: 1, 2 or 4), and the number of components ("VEC3": 3); 0 where
/// unknown.
uint32_t componentBytes(int64_t componentType);
uint32_t componentCount(const std::string& type);

} // namespace relume::gltf
