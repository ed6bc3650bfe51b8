#pragma once

#include <array>
#include <cstdint>

#include "bake/base/shader_types.h"

namespace relume {

/// The points that the samples of one chunk's patches start from (shader::startPoint), by component: for a
/// sample of all patches at once.
class ChunkStarts {
public:
    using Lane = std::array<float, shader::kChunk>;
    struct alignas(64) Points {
        Lane x, y, z; // [m]
        glm::vec3 at(size_t i) const { return {x[i], y[i], z[i]}; }
        void set(size_t i, const glm::vec3& p) { x[i] = p.x, y[i] = p.y, z[i] = p.z; }
    };

    /// Takes the chunk's 64 patches and their covers; without covers all samples start at the patches' own
    /// points.
    void setPatches(const shader::Patch* patches, const shader::PatchCover* covers);
    /// Makes the points of sample `number`, on the surface, to the last bit or two.
    void make(uint32_t number, Points& out) const;
    /// Tells whether samples start elsewhere than at the patches' own points.
    bool move() const { return move_; }

private:
    void setCover(uint32_t lane, const shader::PatchCover& cover);

    bool move_ = false;
    struct alignas(64) Lanes {
        Lane px, py, pz;             // the texels' corners; where nothing moves the patches' own points [m]
        Lane ux, uy, uz, vx, vy, vz; // edges [m], zero where nothing moves
        std::array<std::array<uint32_t, shader::kChunk>, shader::kReplicates> seed;
    } lanes_;
    uint64_t parts_ = 0; // bit i: only some cells of patch i's texel are covered
    // These cells, counted along their bits: so a number finds its cell without a walk.
    std::array<std::array<uint8_t, shader::kCoverEdge * shader::kCoverEdge>, shader::kChunk> cells_;
    std::array<uint8_t, shader::kChunk> cellCount_;
};

} // namespace relume
