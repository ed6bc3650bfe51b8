#include "bake/trace/embree_rays.h"

#include "assets/error.h"

namespace relume {

using shader::kChunk;

namespace {

constexpr uint32_t kCellBits = 4; // cells along an edge of the unit square: 2^4
constexpr uint32_t kCells = 1u << (2 * kCellBits);

} // namespace

void ChunkRays::setPatches(const shader::Patch* patches, bool perTile) {
    for (uint32_t i = 0; i < kChunk; ++i) {
        const shader::Patch& patch = patches[i];
        frames_.sx[i] = patch.shading.x, frames_.sy[i] = patch.shading.y, frames_.sz[i] = patch.shading.z;
        frames_.nx[i] = patch.normal.x, frames_.ny[i] = patch.normal.y, frames_.nz[i] = patch.normal.z;
        const uint32_t key = shader::seedKey(patches[perTile ? 0 : i]);
        for (uint32_t r = 0; r < shader::kReplicates; ++r)
            frames_.seed[r][i] = shader::replicateSeed(key, r);
    }
}

// shader::patchDirection for one sample of all patches, in a form that compilers turn into vector code.
// Always inlined, to be compiled once for each instruction set.
[[gnu::always_inline]] static inline void fillLanes(const float* const* frames, const uint32_t* seed,
                                                    uint32_t sample, float* const* out, uint32_t* cell) {
    const float* __restrict sx = frames[0];
    const float* __restrict sy = frames[1];
    const float* __restrict sz = frames[2];
    const float* __restrict nx = frames[3];
    const float* __restrict ny = frames[4];
    const float* __restrict nz = frames[5];
    float* __restrict x = out[0];
    float* __restrict y = out[1];
    float* __restrict z = out[2];
    for (uint32_t i = 0; i < kChunk; ++i) {
        const glm::vec2 u = shader::sobolPoint(sample, seed[i]);
        const glm::vec3 d = shader::aroundNormal(glm::vec3(sx[i], sy[i], sz[i]), shader::cosineDirection(u));
        const float c = d.x * nx[i] + d.y * ny[i] + d.z * nz[i];
        const float mirror = c < 0.0f ? 2.0f * c : 0.0f;
        x[i] = d.x - mirror * nx[i];
        y[i] = d.y - mirror * ny[i];
        z[i] = d.z - mirror * nz[i];
        // Cells in Morton order: neighbours in the list are mostly neighbours in the square.
        uint32_t column = uint32_t(int(u.x * float(1u << kCellBits))),
                 row = uint32_t(int(u.y * float(1u << kCellBits)));
        column = (column | column << 2) & 0x33u, row = (row | row << 2) & 0x33u;
        column = (column | column << 1) & 0x55u, row = (row | row << 1) & 0x55u;
        cell[i] = column | row << 1;
    }
}

using FillLanes = void (*)(const float* const*, const uint32_t*, uint32_t, float* const*, uint32_t*);

static void fillPlain(const float* const* frames, const uint32_t* seed, uint32_t sample, float* const* out,
                      uint32_t* cell) {
    fillLanes(frames, seed, sample, out, cell);
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) static void fillAvx2(const float* const* frames, const uint32_t* seed,
                                                     uint32_t sample, float* const* out, uint32_t* cell) {
    fillLanes(frames, seed, sample, out, cell);
}
static FillLanes chooseFill() {
    return __builtin_cpu_supports("avx2") ? fillAvx2 : fillPlain;
}
#else
static FillLanes chooseFill() {
    return fillPlain;
}
#endif

void fillDirections(ChunkRays& rays, uint32_t sample, uint32_t slot) {
    static const FillLanes fill = chooseFill();
    const ChunkRays::Frames& f = rays.frames_;
    const float* const frames[] = {f.sx.data(), f.sy.data(), f.sz.data(),
                                   f.nx.data(), f.ny.data(), f.nz.data()};
    float* const out[] = {&rays.x[slot], &rays.y[slot], &rays.z[slot]};
    fill(frames, f.seed[sample % shader::kReplicates].data(), shader::replicateIndex(sample), out,
         &rays.cell_[slot]);
}

void ChunkRays::setSamples(uint32_t first, uint32_t count) {
    ASSERT(count <= kSamplesMax);
    count_ = count * kChunk;
    for (uint32_t k = 0; k < count; ++k)
        fillDirections(*this, first + k, k * kChunk);
    sort();
}

// A counting sort by cell.
void ChunkRays::sort() {
    std::array<uint16_t, kCells + 1> begin{};
    for (uint32_t i = 0; i < count_; ++i)
        ++begin[cell_[i] + 1];
    for (uint32_t c = 0; c < kCells; ++c)
        begin[c + 1] = uint16_t(begin[c + 1] + begin[c]);
    for (uint32_t i = 0; i < count_; ++i)
        order_[begin[cell_[i]]++] = uint16_t(i);
}

} // namespace relume
