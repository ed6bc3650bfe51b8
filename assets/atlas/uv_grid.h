#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

namespace relume {

/// Counts how many triangles cover the centres of a grid's cells, which measures coverage and overlap of UVs.
/// Triangles that share an edge never count twice along it.
class UvGrid {
public:
    /// Makes size x size cells over [low, high].
    UvGrid(uint32_t size, glm::dvec2 low, glm::dvec2 high);

    /// Adds a triangle of either winding; parts outside the grid are ignored.
    void add(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c);

    /// Holds what some triangles have added to a grid.
    struct Added {
        uint64_t covered = 0, overlapped = 0, visits = 0; // cells, as below
    };
    /// Adds a triangle while other threads may add theirs. What it adds to the counts below, which nobody may
    /// look at meanwhile, is told to `added`, for count().
    void addBeside(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c, Added& added);
    /// Counts what was added beside other threads; one thread calls it at a time.
    void count(const Added& added);

    /// Adds the triangle unless it covers a cell that another one covers; tells whether it was added.
    bool addIfFree(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c);

    uint64_t covered() const { return covered_; }       // cells with at least one triangle
    uint64_t overlapped() const { return overlapped_; } // cells with at least two
    uint64_t cells() const { return counts_.size(); }
    uint64_t visits() const { return visits_; } // cells of all triangles so far: what adding them has cost

    /// Tells whether more than this share of the covered cells is overlapped.
    bool overlaps(double share) const {
        return static_cast<double>(overlapped_) > share * static_cast<double>(covered_);
    }
    uint8_t count(uint32_t x, uint32_t y) const { return counts_[size_t(y) * size_ + x]; } // stops at 255

    /// Returns how many cells to a side resolve the overlap of so many triangles to well below 1 %.
    static uint32_t sizeFor(size_t triangles);

private:
    struct Point {
        int64_t x, y; // 1/256 cell
    };
    Point snap(glm::dvec2 p) const;
    template<typename Visit>
    bool forEachSpan(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c, const Visit& visit) const;

    uint32_t size_;
    glm::dvec2 low_, scale_;
    std::vector<uint8_t> counts_;
    uint64_t covered_ = 0, overlapped_ = 0, visits_ = 0;
};

} // namespace relume
