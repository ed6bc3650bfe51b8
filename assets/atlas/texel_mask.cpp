#include "assets/atlas/texel_mask.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace relume {

namespace {

// UVs are floats: in an atlas of 16384 texels they are exact to 1/1024 texel, so that a border on a texel's
// edge may stick out by so much. It touches nothing there.
constexpr double kTouch = 1.0 / 256.0; // [texels]

/// Returns a word whose bits [begin, end) are set, 0 <= begin < end <= 64.
uint64_t bitsBetween(uint32_t begin, uint32_t end) {
    return (~uint64_t{0} >> (64 - (end - begin))) << begin;
}

/// Widens [low, high] by the x of the edge from a to b within the rows [bottom, top].
void spanOfEdge(glm::dvec2 a, glm::dvec2 b, double bottom, double top, double& low, double& high) {
    if (a.y > b.y) std::swap(a, b);
    if (b.y < bottom || a.y > top) return;
    const double slope = b.y > a.y ? (b.x - a.x) / (b.y - a.y) : 0.0;
    const double first = a.y < bottom ? a.x + (bottom - a.y) * slope : a.x;
    const double last = b.y > top ? a.x + (top - a.y) * slope : b.x;
    low = std::min({low, first, last});
    high = std::max({high, first, last});
}

} // namespace

TexelMask::TexelMask(uint32_t width, uint32_t height)
    : width_(width), height_(height), words_((width + 63) / 64), bits_(size_t(words_) * height) {}

uint64_t TexelMask::count() const {
    uint64_t sum = 0;
    for (uint64_t word : bits_)
        sum += static_cast<uint64_t>(std::popcount(word));
    return sum;
}

void TexelMask::addRun(int64_t row, int64_t begin, int64_t end) {
    begin = std::max<int64_t>(begin, 0);
    end = std::min<int64_t>(end, width_);
    if (row < 0 || row >= height_ || begin >= end) return;
    uint64_t* words = bits_.data() + static_cast<size_t>(row) * words_;
    const auto first = static_cast<uint32_t>(begin), last = static_cast<uint32_t>(end);
    for (uint32_t w = first / 64; w <= (last - 1) / 64; ++w)
        words[w] |= bitsBetween(std::max(first, 64 * w) - 64 * w, std::min(last, 64 * w + 64) - 64 * w);
}

void TexelMask::addGrown(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c, glm::dvec2 growth) {
    const double bottom = std::min({a.y, b.y, c.y}) - growth.y, top = std::max({a.y, b.y, c.y}) + growth.y;
    const double rowBegin = std::max(std::floor(bottom + kTouch), 0.0);
    const double rowEnd = std::min(std::ceil(top - kTouch), double(height_));
    // A triangle flatter than the tolerance still has the texels that its middle lies in.
    const double middle = std::floor(0.5 * (bottom + top));
    const auto first = static_cast<int64_t>(rowBegin < rowEnd ? rowBegin : middle);
    const auto last = static_cast<int64_t>(rowBegin < rowEnd ? rowEnd : middle + 1.0);
    for (int64_t y = first; y < last; ++y) {
        double low = INFINITY, high = -INFINITY;
        const double y0 = static_cast<double>(y) - growth.y, y1 = static_cast<double>(y) + 1.0 + growth.y;
        spanOfEdge(a, b, y0, y1, low, high);
        spanOfEdge(b, c, y0, y1, low, high);
        spanOfEdge(c, a, y0, y1, low, high);
        if (!(low <= high)) continue;
        low -= growth.x;
        high += growth.x;
        const double begin = std::floor(low + kTouch), end = std::ceil(high - kTouch);
        const double centre = std::floor(0.5 * (low + high));
        addRun(y, static_cast<int64_t>(begin < end ? begin : centre),
               static_cast<int64_t>(begin < end ? end : centre + 1.0));
    }
}

TexelMask TexelMask::turned() const {
    TexelMask result(height_, width_);
    for (const TexelRun& run : runs()) {
        const uint32_t x = height_ - 1 - run.row;
        for (uint32_t y = run.begin; y < run.end; ++y)
            result.bits_[size_t(y) * result.words_ + x / 64] |= uint64_t{1} << (x % 64);
    }
    return result;
}

std::vector<TexelRun> TexelMask::runs() const {
    std::vector<TexelRun> result;
    for (uint32_t y = 0; y < height_; ++y) {
        bool open = false; // a run reaches the end of the word before
        for (uint32_t w = 0; w < words_; ++w) {
            uint64_t word = row(y)[w];
            while (word != 0) {
                const auto begin = static_cast<uint32_t>(std::countr_zero(word));
                const auto length = static_cast<uint32_t>(std::countr_one(word >> begin));
                if (open && begin == 0)
                    result.back().end += length;
                else
                    result.push_back({y, 64 * w + begin, 64 * w + begin + length});
                if (begin + length == 64) break;
                word &= ~bitsBetween(begin, begin + length);
            }
            open = row(y)[w] >> 63 != 0;
        }
    }
    return result;
}

} // namespace relume
