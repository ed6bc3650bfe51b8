#include "assets/atlas/chart_quality.h"

#include "assets/atlas/uv_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace relume {

namespace {

constexpr double kDepth = 1e-6;      // of a chart's extent: below it two triangles only touch
constexpr size_t kMostEntries = 24;  // cells per triangle on average; beyond, the triangles are thin and long
constexpr size_t kMostPairs = 400;   // compared pairs per triangle on average, likewise
constexpr uint32_t kFineCells = 512; // to a side of the grid that counts where pairs are too many

double crossOf(const glm::dvec2& a, const glm::dvec2& b) {
    return a.x * b.y - a.y * b.x;
}

struct FlatBox {
    glm::dvec2 low, high;
};

FlatBox boxOf(const glm::dvec2* p) {
    return {glm::min(glm::min(p[0], p[1]), p[2]), glm::max(glm::max(p[0], p[1]), p[2])};
}

/// Tells whether an edge of the first triangle has all of the second on its outer side.
bool edgeSeparates(const glm::dvec2* a, const glm::dvec2* b, double depth) {
    for (int k = 0; k < 3; ++k) {
        const glm::dvec2 edge = a[(k + 1) % 3] - a[k];
        const double most = depth * std::sqrt(glm::dot(edge, edge));
        if (crossOf(edge, b[0] - a[k]) <= most && crossOf(edge, b[1] - a[k]) <= most &&
            crossOf(edge, b[2] - a[k]) <= most)
            return true;
    }
    return false;
}

/// Finds pairs of triangles that cover each other, by way of cells that list the triangles in them.
class PairFinder {
public:
    PairFinder(std::span<const glm::dvec2> uv, size_t second);
    bool overlaps();

private:
    struct Cells {
        uint32_t x0, y0, x1, y1;
    };
    Cells cellsOf(size_t triangle) const;
    uint32_t columnOf(double x) const;
    uint32_t rowOf(double y) const;
    bool list();
    bool compare(uint32_t cell, bool& tooMany);
    bool countCells() const;

    std::span<const glm::dvec2> uv_;
    const size_t count_, second_;
    glm::dvec2 low_{0.0}, high_{0.0}, scale_{0.0};
    double depth_ = 0.0;
    uint32_t width_ = 1, height_ = 1;
    std::vector<FlatBox> boxes_;
    std::vector<uint32_t> first_, entries_; // of cells
    size_t pairs_ = 0;
};

PairFinder::PairFinder(std::span<const glm::dvec2> uv, size_t second)
    : uv_(uv), count_(uv.size() / 3), second_(second), boxes_(count_) {
    low_ = glm::dvec2(std::numeric_limits<double>::max());
    high_ = -low_;
    for (size_t t = 0; t < count_; ++t) {
        boxes_[t] = boxOf(&uv[3 * t]);
        low_ = glm::min(low_, boxes_[t].low);
        high_ = glm::max(high_, boxes_[t].high);
    }
    const glm::dvec2 extent = high_ - low_;
    depth_ = kDepth * std::max(extent.x, extent.y);
    const double cell = std::sqrt(std::max(extent.x * extent.y, 0.0) / double(count_));
    if (!(cell > 0.0)) return;
    const double most = 4.0 * double(count_) + 4.0;
    width_ = static_cast<uint32_t>(std::clamp(extent.x / cell, 1.0, most));
    height_ = static_cast<uint32_t>(std::clamp(extent.y / cell, 1.0, most / width_));
    scale_ = glm::dvec2(width_, height_) / extent;
}

uint32_t PairFinder::columnOf(double x) const {
    return std::min(static_cast<uint32_t>(std::max((x - low_.x) * scale_.x, 0.0)), width_ - 1);
}

uint32_t PairFinder::rowOf(double y) const {
    return std::min(static_cast<uint32_t>(std::max((y - low_.y) * scale_.y, 0.0)), height_ - 1);
}

PairFinder::Cells PairFinder::cellsOf(size_t t) const {
    return {columnOf(boxes_[t].low.x), rowOf(boxes_[t].low.y), columnOf(boxes_[t].high.x),
            rowOf(boxes_[t].high.y)};
}

/// Lists the triangles of each cell; false where there would be too many entries.
bool PairFinder::list() {
    first_.assign(size_t(width_) * height_ + 1, 0);
    size_t entries = 0;
    for (size_t t = 0; t < count_; ++t) {
        const Cells c = cellsOf(t);
        entries += size_t(c.x1 - c.x0 + 1) * (c.y1 - c.y0 + 1);
        if (entries > kMostEntries * count_ + 1024) return false;
        for (uint32_t y = c.y0; y <= c.y1; ++y)
            for (uint32_t x = c.x0; x <= c.x1; ++x)
                ++first_[size_t(y) * width_ + x + 1];
    }
    for (size_t i = 1; i < first_.size(); ++i)
        first_[i] += first_[i - 1];
    entries_.resize(entries);
    std::vector<uint32_t> at(first_.begin(), first_.end() - 1);
    for (size_t t = 0; t < count_; ++t) {
        const Cells c = cellsOf(t);
        for (uint32_t y = c.y0; y <= c.y1; ++y)
            for (uint32_t x = c.x0; x <= c.x1; ++x)
                entries_[at[size_t(y) * width_ + x]++] = static_cast<uint32_t>(t);
    }
    return true;
}

bool PairFinder::compare(uint32_t cell, bool& tooMany) {
    for (uint32_t i = first_[cell]; i < first_[cell + 1]; ++i) {
        const uint32_t a = entries_[i];
        const FlatBox& boxA = boxes_[a];
        for (uint32_t k = i + 1; k < first_[cell + 1]; ++k) {
            const uint32_t b = entries_[k];
            if (second_ > 0 && (a < second_) == (b < second_)) continue;
            const FlatBox& boxB = boxes_[b];
            const glm::dvec2 low = glm::max(boxA.low, boxB.low), high = glm::min(boxA.high, boxB.high);
            if (!(low.x + depth_ < high.x) || !(low.y + depth_ < high.y)) continue;
            // Both are in all cells of their common box, and meet in the first of them.
            if (size_t(rowOf(low.y)) * width_ + columnOf(low.x) != cell) continue;
            if (++pairs_ > kMostPairs * count_ + 4096) {
                tooMany = true;
                return false;
            }
            if (!edgeSeparates(&uv_[3 * a], &uv_[3 * b], depth_) &&
                !edgeSeparates(&uv_[3 * b], &uv_[3 * a], depth_))
                return true;
        }
    }
    return false;
}

bool PairFinder::countCells() const {
    UvGrid grid(std::max(kFineCells, UvGrid::sizeFor(count_)), low_, high_);
    for (size_t t = 0; t < count_; ++t)
        grid.add(uv_[3 * t], uv_[3 * t + 1], uv_[3 * t + 2]);
    return grid.overlapped() > 0;
}

bool PairFinder::overlaps() {
    if (count_ < 2) return false;
    if (!list()) return countCells();
    bool tooMany = false;
    for (uint32_t cell = 0; cell + 1 < first_.size(); ++cell) {
        if (compare(cell, tooMany)) return true;
        if (tooMany) return countCells();
    }
    return false;
}

} // namespace

void Stretch::add(const glm::dvec3* q, const glm::dvec2* p) {
    const double area = 0.5 * glm::length(glm::cross(q[1] - q[0], q[2] - q[0]));
    const double twice = crossOf(p[1] - p[0], p[2] - p[0]);
    surface += area;
    flat += 0.5 * twice;
    if (!(twice > 0.0)) {
        if (area > 0.0) squares = std::numeric_limits<double>::infinity();
        return;
    }
    const glm::dvec3 ds =
        (q[0] * (p[1].y - p[2].y) + q[1] * (p[2].y - p[0].y) + q[2] * (p[0].y - p[1].y)) / twice;
    const glm::dvec3 dt =
        (q[0] * (p[2].x - p[1].x) + q[1] * (p[0].x - p[2].x) + q[2] * (p[1].x - p[0].x)) / twice;
    squares += area * 0.5 * (glm::dot(ds, ds) + glm::dot(dt, dt));
}

void Stretch::add(const Stretch& other) {
    surface += other.surface;
    flat += other.flat;
    squares += other.squares;
}

double Stretch::normalised() const {
    if (!(surface > 0.0)) return 1.0;
    return std::sqrt(squares / surface) * std::sqrt(std::max(flat, 0.0) / surface);
}

Stretch measureStretch(std::span<const glm::dvec3> corners, std::span<const glm::dvec2> uv) {
    Stretch stretch;
    for (size_t i = 0; i + 2 < corners.size(); i += 3)
        stretch.add(&corners[i], &uv[i]);
    return stretch;
}

bool chartOverlaps(std::span<const glm::dvec2> uv, size_t second) {
    return PairFinder(uv, second).overlaps();
}

} // namespace relume
