#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

namespace relume {

/// A run of texels in one row of a mask: columns [begin, end).
struct TexelRun {
    uint32_t row, begin, end;
};

/// A set of texels in a box, one bit for each.
class TexelMask {
public:
    TexelMask() = default;
    TexelMask(uint32_t width, uint32_t height);

    uint32_t width() const { return width_; }
    uint32_t height() const { return height_; }
    bool has(uint32_t x, uint32_t y) const { return row(y)[x / 64] >> (x % 64) & 1u; }
    uint64_t count() const;
    /// Adds the columns [begin, end) of a row; what lies beyond the box is ignored.
    void addRun(int64_t row, int64_t begin, int64_t end);
    /// Adds each texel into which the triangle [texels] reaches by more than 1/256 of a texel.
    void addTouched(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c) { addGrown(a, b, c, glm::dvec2(0.0)); }
    /// Does so for texels that are larger by `growth` to each of their sides. With half a texel these are all
    /// that bilinear filters read for points of the triangle.
    void addGrown(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c, glm::dvec2 growth);

    /// Returns the mask after a quarter turn: the texel (x, y) goes to (height - 1 - y, x).
    TexelMask turned() const;
    /// Returns the runs of all rows, row by row from 0 on.
    std::vector<TexelRun> runs() const;

private:
    const uint64_t* row(uint32_t y) const { return bits_.data() + size_t(y) * words_; }

    uint32_t width_ = 0, height_ = 0, words_ = 0; // 64-bit words to a row
    std::vector<uint64_t> bits_;
};

} // namespace relume
