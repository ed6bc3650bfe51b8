#pragma once

#include <optional>
#include <vector>

#include <glm/glm.hpp>

namespace relume {

/// A part of a lightmap [texels].
struct TexelWindow {
    uint32_t column = 0, row = 0, columns = 0, rows = 0;

    size_t size() const { return size_t{columns} * rows; }
    bool has(uint32_t x, uint32_t y) const { // wraps below the first one
        return x - column < columns && y - row < rows;
    }
    /// Returns the place of a texel of the lightmap, which is in here, among the window's texels, row by row.
    size_t index(uint32_t x, uint32_t y) const { return size_t{y - row} * columns + (x - column); }
};

/// The result of the CIT pass (calculate initial textures: UV-space rasterization) in every texel, row 0 = v
/// 0. Texels without a surface are zero.
struct TextureGroup {
    uint32_t size = 0;               // of the lightmap [texels]
    TexelWindow window;              // the texels that are here
    std::vector<glm::vec4> pos;      // [m], a = 1: a patch
    std::vector<glm::vec4> nrm;      // unit, shading
    std::vector<glm::vec4> mat;      // albedo for a base colour factor of 1
    std::vector<glm::vec4> emission; // for an emission factor of 1 cd/m^2
    std::vector<uint32_t> triangle;  // 1 + index in the WorldMesh
    // The share of each texel's surface that is solid (masked_texels.h); empty: nothing is masked.
    std::vector<float> solid;

    float solidAt(size_t texel) const { return solid.empty() ? 1.0f : solid[texel]; }
};

struct CitDesc {
    uint32_t size = 512;
    bool conservative = false;              // every texel that a triangle touches becomes a patch
    bool rtrad = false;                     // albedo = base colour, whatever the metallic factor
    std::optional<TexelWindow> window = {}; // the texels that are asked for; nothing: all
};

} // namespace relume
