#pragma once

#include <array>
#include <cstdint>

#include "bake/base/shader_types.h"
#include "bake/trace/chunk_starts.h"

namespace relume {

/// The cosine-distributed rays of one chunk's patches for some consecutive samples, by component. Sample k of
/// patch i is number k * 64 + i. It takes 49 KiB, and is made to be reused.
class ChunkRays {
public:
    static constexpr uint32_t kSamplesMax = 16;
    static constexpr uint32_t kRaysMax = kSamplesMax * shader::kChunk;
    template<typename T>
    using Rays = std::array<T, kRaysMax>;

    /// Takes the chunk's 64 patches and their covers (ChunkStarts), a rotation (shader::kRotate...) and the
    /// lightmap edge `size` [texels].
    void setPatches(const shader::Patch* patches, const shader::PatchCover* covers, uint32_t rotation,
                    uint32_t size);
    /// Takes the directions from these points of the disc (shader::discDirection), for patches that are set
    /// from then on; they stay the caller's.
    void setDisc(const glm::vec2* points, uint32_t count) { disc_ = points, discCount_ = count; }
    /// Makes where rays start, and the directions of shader::patchDirection, or those of the disc, to the
    /// last bit or two.
    void setSamples(uint32_t first, uint32_t count);
    /// There are count() rays. order() has their numbers, those that go the same way next to each other: this
    /// makes packets of them worth while.
    uint32_t count() const { return count_; }
    const Rays<uint16_t>& order() const { return order_; }

    alignas(64) Rays<float> x, y, z; // directions, unit
    alignas(64) Rays<float> mirror;  // below 0: the direction was mirrored up (shader::mirroredUp)
    /// Returns where a ray starts [m], off its surface.
    glm::vec3 origin(uint32_t number) const {
        const uint32_t i = number % shader::kChunk;
        return starts_[number / shader::kChunk].at(i) + offsets_[i];
    }

private:
    using Lane = std::array<float, shader::kChunk>;
    void fillDirections(uint32_t sample, uint32_t slot);
    void sort();

    struct alignas(64) Frames {
        Lane sx, sy, sz; // shading normals
        Lane nx, ny, nz; // geometric normals
        std::array<std::array<uint32_t, shader::kChunk>, shader::kReplicates> seed;
        std::array<uint32_t, shader::kChunk> shiftX, shiftY; // shader::memberShift
    } frames_;
    ChunkStarts chunkStarts_;
    std::array<ChunkStarts::Points, kSamplesMax> starts_; // on the surface
    std::array<glm::vec3, shader::kChunk> offsets_;       // from there [m]
    alignas(64) Rays<uint32_t> cell_; // cell of the unit square that the sample's point lies in
    Rays<uint16_t> order_;
    uint32_t count_ = 0;
    const glm::vec2* disc_ = nullptr; // none: Sobol points
    uint32_t discCount_ = 0;
};

} // namespace relume
