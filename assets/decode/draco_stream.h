#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace relume {

/// Names the numbers that a decoded attribute is made of.
enum class NumberType { Int8, Uint8, Int16, Uint16, Uint32, Float };

/// Returns the size of such a number [bytes].
uint32_t bytesOf(NumberType type);

/// Asks for an attribute of a mesh by its number in the stream, as numbers of this type.
struct DracoWish {
    uint32_t id = 0;
    NumberType type = NumberType::Float;
    uint32_t components = 3; // 1 to 16
};

struct DracoMesh {
    uint32_t points = 0;
    std::vector<uint32_t> indices;                // 3 per triangle, each below points
    std::vector<std::vector<uint8_t>> attributes; // one per wish: [points][components], tightly packed
};

/// Says how much a mesh may have.
struct DracoBounds {
    uint64_t points = 0, triangles = 0;
};

/// Decodes a mesh that was compressed by Draco (bitstream 2.2, https://google.github.io/draco/spec), by
/// libdraco. A number that is stored as a float or as an integer of another size is converted, and zeros
/// stand for components that are not stored. The stream is not trusted: what it claims is compared with the
/// bounds before memory is taken for it. Throws Error, without the name of a file, where it is damaged, is no
/// mesh, is beyond the bounds or lacks an attribute.
DracoMesh decodeDraco(std::span<const uint8_t> stream, std::span<const DracoWish> wishes,
                      const DracoBounds& bounds);

} // namespace relume
