#pragma once

#include <array>
#include <cstdint>

#include "bake/trace/bvh_builder.h"
#include "bake/trace/embree_chunks.h"

namespace relume {

/// The convex hull of the boxes that two sets of patches' rays end in: it holds all rays between them. Where
/// no triangle reaches into it, all pairs see each other and no ray is needed [Haines and Wallace 1991].
class Shaft {
public:
    /// Takes boxes of the ends of (some) rays of chunks a and b.
    Shaft(const PatchChunk& a, const EndBox& endsA, const PatchChunk& b, const EndBox& endsB);
    /// Returns true only if no triangle of the tree touches a segment between the two sets. It may return
    /// false all the same: it gives up early where there is much to look at.
    bool isOpen(const Bvh& bvh) const;

private:
    static constexpr uint32_t kPlanes = 8; // 6 are in use: what fits a register
    using Planes = std::array<float, kPlanes>;

    void addPlanes(const EndBox& a, const EndBox& b);
    bool missesBox(const glm::vec3& lo, const glm::vec3& hi) const;
    bool missesTriangle(const shader::BvhTriangle& triangle) const;

    // Each plane goes through an edge of each box: the hull lies where n . p <= d.
    alignas(32) Planes nx_, ny_, nz_, d_;
    EndBox bounds_; // of the hull
    float reach_;   // [m] largest coordinate, for rounding
    const PatchChunk& a_;
    const PatchChunk& b_;
};

} // namespace relume
