#pragma once

#include <cstdint>

#include <glm/glm.hpp>

namespace relume {

constexpr uint32_t kMostPages = 64;
/// The largest edge of a page [texels].
constexpr uint32_t kMaxPageSize = 8192;
/// A page's edge is a multiple of this where there are several [texels], so that no tile of patches spans
/// two.
constexpr uint32_t kPageStep = 8;

/// The pages of a lightmap are squares of one size. In memory they lie row by row on a *sheet*, a square of
/// the least number of columns that has room for all; what is left over stays empty. So a lightmap is one
/// square map wherever light is computed, and only files have pages.
struct LightmapPages {
    uint32_t count = 1; // 1 to kMostPages

    /// Returns how many pages lie side by side on the sheet, and one upon the other.
    constexpr uint32_t columns() const {
        uint32_t columns = 1;
        while (columns * columns < count)
            ++columns;
        return columns;
    }
    /// Returns the edge of the sheet, of a page's [texels].
    constexpr uint32_t sheetOf(uint32_t edge) const { return columns() * edge; }
    /// Returns the edge of a page, of the sheet's [texels].
    constexpr uint32_t edgeOf(uint32_t sheet) const { return sheet / columns(); }
    /// Returns the column and row in which a page lies.
    glm::uvec2 cellOf(uint32_t page) const { return {page % columns(), page / columns()}; }
    /// Returns where UVs of a page lie on the sheet. With one page these are the same, to the bit. With
    /// several they keep off the page's borders by less than 1/100 texel, so that no triangle touches another
    /// page.
    glm::vec2 onSheet(glm::vec2 uv, uint32_t page) const {
        if (count == 1) return uv;
        constexpr float kOff = 1.0f / (1 << 20);
        return (glm::clamp(uv, kOff, 1.0f - kOff) + glm::vec2(cellOf(page))) / static_cast<float>(columns());
    }
    /// Tells whether two texels of a sheet, whose pages have this edge, are on one page.
    static constexpr bool together(uint32_t edge, glm::uvec2 a, glm::uvec2 b) {
        return a.x / edge == b.x / edge && a.y / edge == b.y / edge;
    }

    bool operator==(const LightmapPages&) const = default;
};

/// Returns how many pages of edge `edge` [texels] surfaces of `area` [m^2] need at `density` [texels/m] when
/// charts cover the share `coverage` of each: at least 1, at most kMostPages.
uint32_t pagesForDensity(double area, double density, double coverage, uint32_t edge);

} // namespace relume
