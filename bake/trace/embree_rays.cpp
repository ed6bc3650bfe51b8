#include "bake/trace/embree_rays.h"

#include "assets/base/error.h"

namespace relume {

using shader::kChunk;

namespace {

constexpr uint32_t kCellBits = 4; // cells along an edge of the unit square: 2^4
constexpr uint32_t kCells = 1u << (2 * kCellBits);

} // namespace

void ChunkRays::setPatches(const shader::Patch* patches, const shader::PatchCover* covers, uint32_t rotation,
                           uint32_t size) {
    chunkStarts_.setPatches(patches, covers);
    for (uint32_t i = 0; i < kChunk; ++i) {
        const shader::Patch& patch = patches[i];
        frames_.sx[i] = patch.shading.x, frames_.sy[i] = patch.shading.y, frames_.sz[i] = patch.shading.z;
        frames_.nx[i] = patch.normal.x, frames_.ny[i] = patch.normal.y, frames_.nz[i] = patch.normal.z;
        offsets_[i] = patch.offset * patch.normal;
        const uint32_t key = shader::rotationKey(patch, patches[0], rotation, size);
        const glm::uvec2 shift = shader::memberShift(key);
        frames_.shiftX[i] = shift.x, frames_.shiftY[i] = shift.y;
        for (uint32_t r = 0; r < shader::kReplicates; ++r)
            frames_.seed[r][i] = disc_ ? shader::replicateSeed(key, r) : shader::directionSeed(key, r);
    }
}

namespace {

// Makes one sample for patch i with its seed, before it is turned to its normal. `cell` gets a place in the
// unit square.
struct SobolLanes {
    uint32_t index;
    const uint32_t *shiftX, *shiftY;
    [[gnu::always_inline]] glm::vec3 operator()(uint32_t i, uint32_t seed, glm::vec2& cell) const {
        cell = shader::sobolPoint(index, seed, {shiftX[i], shiftY[i]});
        return shader::cosineDirection(cell);
    }
};
struct DiscLanes {
    const glm::vec2* points;
    uint32_t count, index;
    [[gnu::always_inline]] glm::vec3 operator()(uint32_t, uint32_t seed, glm::vec2& cell) const {
        seed += shader::discTurn(index, count);
        const glm::vec3 d = shader::discDirection(points[shader::discPoint(index, count, seed)], count, seed);
        cell = glm::vec2(0.4999f * d.x + 0.5f, 0.4999f * d.y + 0.5f); // below 1
        return d;
    }
};

} // namespace

// Does what shader::aroundPatch does for one sample of all patches, in a form that compilers turn into vector
// code. It is always inlined, to be compiled once for each instruction set.
template<typename Lanes>
[[gnu::always_inline]] static inline void fillLanes(const float* const* frames, const uint32_t* seed,
                                                    Lanes lanes, float* const* out, uint32_t* cell) {
    const float* __restrict sx = frames[0];
    const float* __restrict sy = frames[1];
    const float* __restrict sz = frames[2];
    const float* __restrict nx = frames[3];
    const float* __restrict ny = frames[4];
    const float* __restrict nz = frames[5];
    float* __restrict x = out[0];
    float* __restrict y = out[1];
    float* __restrict z = out[2];
    float* __restrict mirrored = out[3];
    // When inlined, __restrict is forgotten; run-time checks of all these pairs would be more than compilers
    // take.
#pragma GCC ivdep
    for (uint32_t i = 0; i < kChunk; ++i) {
        glm::vec2 u;
        const glm::vec3 local = lanes(i, seed[i], u);
        const glm::vec3 d = shader::aroundNormal(glm::vec3(sx[i], sy[i], sz[i]), local);
        const float c = d.x * nx[i] + d.y * ny[i] + d.z * nz[i];
        const float mirror = c < 0.0f ? 2.0f * c : 0.0f;
        x[i] = d.x - mirror * nx[i];
        y[i] = d.y - mirror * ny[i];
        z[i] = d.z - mirror * nz[i];
        mirrored[i] = mirror;
        // Cells are in Morton order: neighbours in the list are mostly neighbours in the square.
        uint32_t column = uint32_t(int(u.x * float(1u << kCellBits))),
                 row = uint32_t(int(u.y * float(1u << kCellBits)));
        column = (column | column << 2) & 0x33u, row = (row | row << 2) & 0x33u;
        column = (column | column << 1) & 0x55u, row = (row | row << 1) & 0x55u;
        cell[i] = column | row << 1;
    }
}

template<typename Lanes>
using FillLanes = void (*)(const float* const*, const uint32_t*, Lanes, float* const*, uint32_t*);

template<typename Lanes>
static void fillPlain(const float* const* frames, const uint32_t* seed, Lanes lanes, float* const* out,
                      uint32_t* cell) {
    fillLanes(frames, seed, lanes, out, cell);
}

#if defined(__x86_64__)
template<typename Lanes>
__attribute__((target("avx2"))) static void fillAvx2(const float* const* frames, const uint32_t* seed,
                                                     Lanes lanes, float* const* out, uint32_t* cell) {
    fillLanes(frames, seed, lanes, out, cell);
}
template<typename Lanes>
static FillLanes<Lanes> chooseFill() {
    return __builtin_cpu_supports("avx2") ? fillAvx2<Lanes> : fillPlain<Lanes>;
}
#else
template<typename Lanes>
static FillLanes<Lanes> chooseFill() {
    return fillPlain<Lanes>;
}
#endif

void ChunkRays::fillDirections(uint32_t sample, uint32_t slot) {
    static const FillLanes<SobolLanes> fillSobol = chooseFill<SobolLanes>();
    static const FillLanes<DiscLanes> fillDisc = chooseFill<DiscLanes>();
    const Frames& f = frames_;
    const float* const frames[] = {f.sx.data(), f.sy.data(), f.sz.data(),
                                   f.nx.data(), f.ny.data(), f.nz.data()};
    float* const out[] = {&x[slot], &y[slot], &z[slot], &mirror[slot]};
    const uint32_t* seed = f.seed[sample % shader::kReplicates].data();
    if (disc_)
        fillDisc(frames, seed, {disc_, discCount_, sample}, out, &cell_[slot]);
    else
        fillSobol(frames, seed, {shader::replicateIndex(sample), f.shiftX.data(), f.shiftY.data()}, out,
                  &cell_[slot]);
}

void ChunkRays::setSamples(uint32_t first, uint32_t count) {
    ASSERT(count <= kSamplesMax);
    count_ = count * kChunk;
    for (uint32_t k = 0; k < count; ++k) {
        fillDirections(first + k, k * kChunk);
        chunkStarts_.make(first + k, starts_[k]);
    }
    sort();
}

// Sorts by cell, by counting.
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
