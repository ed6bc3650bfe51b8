#include "assets/atlas/uv_grid.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

namespace relume {

namespace {

constexpr int64_t kSub = 256; // steps per cell: integer edge functions make shared edges exact

int64_t floorDiv(int64_t a, int64_t b) { // b > 0
    return a >= 0 ? a / b : -((-a + b - 1) / b);
}

} // namespace

UvGrid::UvGrid(uint32_t size, glm::dvec2 low, glm::dvec2 high)
    : size_(size), low_(low), counts_(size_t(size) * size) {
    const glm::dvec2 extent = high - low;
    for (int c = 0; c < 2; ++c)
        scale_[c] = extent[c] > 0.0 ? size * double(kSub) / extent[c] : 0.0;
}

UvGrid::Point UvGrid::snap(glm::dvec2 p) const {
    // The bound keeps the products below 2^63 for points far outside.
    const double bound = 64.0 * size_ * kSub;
    const glm::dvec2 q = (p - low_) * scale_;
    return {std::llround(std::clamp(q.x, -bound, bound)), std::llround(std::clamp(q.y, -bound, bound))};
}

/// Calls visit(first cell, one past the last) for each row of the triangle, until one call returns false.
template<typename Visit>
bool UvGrid::forEachSpan(glm::dvec2 pa, glm::dvec2 pb, glm::dvec2 pc, const Visit& visit) const {
    std::array<Point, 3> p = {snap(pa), snap(pb), snap(pc)};
    const int64_t area = (p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[1].y - p[0].y) * (p[2].x - p[0].x);
    if (area == 0) return true;
    if (area < 0) std::swap(p[1], p[2]);
    const auto [low, high] = std::minmax({p[0].y, p[1].y, p[2].y});
    const int64_t rows = size_;
    const int64_t rowBegin = std::max<int64_t>(floorDiv(low - kSub / 2, kSub), 0);
    const int64_t rowEnd = std::min(floorDiv(high - kSub / 2, kSub) + 1, rows);
    for (int64_t row = rowBegin; row < rowEnd; ++row) {
        const int64_t y = row * kSub + kSub / 2;
        int64_t begin = 0, end = rows; // cells of this row inside all three edges
        for (int e = 0; e < 3 && begin < end; ++e) {
            const Point &a = p[e], &b = p[(e + 1) % 3];
            const int64_t dx = b.x - a.x, dy = b.y - a.y;
            // A cell is inside where dx (y - a.y) - dy (x - a.x) > 0; a centre on an edge belongs to one of
            // its two triangles.
            const bool owns = dy < 0 || (dy == 0 && dx > 0);
            const int64_t rest =
                dx * (y - a.y) + dy * a.x - dy * (kSub / 2) - (owns ? 0 : 1); // >= dy * kSub * i
            if (dy == 0) {
                if (rest < 0) end = begin;
            } else if (dy > 0) {
                end = std::min(end, floorDiv(rest, dy * kSub) + 1);
            } else {
                begin = std::max(begin, -floorDiv(rest, -dy * kSub));
            }
        }
        const size_t first = size_t(row) * size_;
        if (begin < end && !visit(first + static_cast<size_t>(begin), first + static_cast<size_t>(end)))
            return false;
    }
    return true;
}

void UvGrid::add(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c) {
    forEachSpan(a, b, c, [this](size_t begin, size_t end) {
        visits_ += end - begin;
        for (size_t i = begin; i < end; ++i) {
            covered_ += counts_[i] == 0;
            overlapped_ += counts_[i] == 1;
            counts_[i] = static_cast<uint8_t>(std::min(counts_[i] + 1, 255));
        }
        return true;
    });
}

void UvGrid::addBeside(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c, Added& added) {
    forEachSpan(a, b, c, [&](size_t begin, size_t end) {
        added.visits += end - begin;
        for (size_t i = begin; i < end; ++i) {
            const std::atomic_ref<uint8_t> cell(counts_[i]);
            uint8_t before = cell.load(std::memory_order_relaxed);
            while (before < 255 && !cell.compare_exchange_weak(before, static_cast<uint8_t>(before + 1),
                                                               std::memory_order_relaxed)) {
            }
            added.covered += before == 0;
            added.overlapped += before == 1;
        }
        return true;
    });
}

void UvGrid::count(const Added& added) {
    covered_ += added.covered;
    overlapped_ += added.overlapped;
    visits_ += added.visits;
}

bool UvGrid::addIfFree(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c) {
    const bool isFree = forEachSpan(a, b, c, [this](size_t begin, size_t end) {
        const auto first = counts_.begin() + static_cast<std::ptrdiff_t>(begin);
        return std::all_of(first, first + static_cast<std::ptrdiff_t>(end - begin),
                           [](uint8_t n) { return n == 0; });
    });
    if (isFree) add(a, b, c);
    return isFree;
}

uint32_t UvGrid::sizeFor(size_t triangles) {
    // There are about 16 cells per triangle; the smallest grid resolves 1 % of a single quad into 160 cells.
    uint32_t size = 128;
    while (size < 2048 && size_t(size) * size < 16 * triangles)
        size *= 2;
    return size;
}

} // namespace relume
