#pragma once

#include <array>
#include <cstdint>

#include "bake/trace/embree_chunks.h"

namespace relume {

/// The triangles that stopped the latest rays of a block of pairs: rays between neighbouring patches are
/// mostly stopped by the same ones, and asking those costs a hundredth of a ray. It borrows the corners.
class Blockers {
public:
    /// Takes three corners per triangle, as WorldMesh has them.
    explicit Blockers(const glm::vec3* positions) : positions_(positions) {}

    /// Takes in an opaque triangle.
    void add(uint32_t triangle);
    /// Returns those of `asked` that a known triangle certainly stops: bit j is the segment from `origin` to
    /// the end of b's patch j. Segments that pass so close to an edge or end so close to the plane that
    /// rounding matters are not among them.
    uint64_t stopped(const glm::vec3& origin, const PatchChunk& b, uint64_t asked);

private:
    // This is enough for a silhouette of a few surfaces; more cost more than they find.
    static constexpr uint32_t kMax = 4;
    struct Entry {
        uint32_t triangle = 0;
        uint32_t idle = 0; // rows since it last stopped a ray
    };

    const glm::vec3* positions_;
    std::array<Entry, kMax> entries_;
    uint32_t count_ = 0;
};

} // namespace relume
