#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace relume {

enum class MeshoptMode { Attributes, Triangles, Indices };
enum class MeshoptFilter { None, Octahedral, Quaternion, Exponential };

/// Describes what a stream of EXT_meshopt_compression holds.
struct MeshoptLayout {
    uint64_t count = 0;  // of elements
    uint32_t stride = 0; // bytes of an element
    MeshoptMode mode = MeshoptMode::Attributes;
    MeshoptFilter filter = MeshoptFilter::None; // of attributes alone
};

/// Decodes a stream to `count` elements of `stride` bytes, tightly packed, by libmeshoptimizer, as the glTF
/// extension EXT_meshopt_compression defines it. Filters turn octahedral normals, quaternions and shared
/// exponents into the numbers that an accessor reads. The stream is not trusted: no memory is taken for more
/// elements than its bytes can hold. Indices may be any: whoever uses them checks them. Throws Error, without
/// the name of a file, where the stream is damaged or the layout is none that the extension knows.
std::vector<uint8_t> decodeMeshopt(std::span<const uint8_t> stream, const MeshoptLayout& layout);

} // namespace relume
