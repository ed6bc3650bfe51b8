#include "bake/trace/embree_chunks.h"

#include <algorithm>
#include <bit>
#include <limits>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace relume {

using shader::kChunk;
using shader::Patch;

namespace {

void addPatch(PatchChunk& chunk, uint32_t j, const Patch& patch, bool rtrad) {
    const glm::vec3 end = rtrad ? patch.position : patch.position + patch.offset * patch.normal;
    chunk.px[j] = patch.position.x, chunk.py[j] = patch.position.y, chunk.pz[j] = patch.position.z;
    chunk.nx[j] = patch.normal.x, chunk.ny[j] = patch.normal.y, chunk.nz[j] = patch.normal.z;
    chunk.ex[j] = end.x, chunk.ey[j] = end.y, chunk.ez[j] = end.z;
    chunk.offset[j] = patch.offset;
    if ((patch.flags & shader::kPatchSends) == 0) return;
    if (chunk.sends == 0) chunk.plane = patch.normal;
    if (chunk.plane != patch.normal) chunk.plane = glm::vec3(0);
    chunk.sends |= uint64_t(1) << j;
    chunk.lo = glm::min(chunk.lo, patch.position);
    chunk.hi = glm::max(chunk.hi, patch.position);
    chunk.margin = std::min(chunk.margin, patch.offset);
}

void boundEnds(PatchChunk& chunk) {
    if (chunk.sends == 0) return;
    const uint32_t sender = uint32_t(std::countr_zero(chunk.sends));
    for (uint32_t j = 0; j < kChunk; ++j) {
        if (chunk.sends >> j & 1) continue;
        chunk.ex[j] = chunk.ex[sender], chunk.ey[j] = chunk.ey[sender], chunk.ez[j] = chunk.ez[sender];
    }
    const auto bound = [&](uint64_t patches) {
        EndBox box{glm::vec3(std::numeric_limits<float>::infinity()),
                   glm::vec3(-std::numeric_limits<float>::infinity())};
        for (uint32_t j = 0; j < kChunk; ++j) {
            if ((patches >> j & 1) == 0) continue;
            const glm::vec3 end(chunk.ex[j], chunk.ey[j], chunk.ez[j]);
            box = {glm::min(box.lo, end), glm::max(box.hi, end)};
        }
        return box;
    };
    chunk.ends = bound(chunk.sends);
    for (size_t q = 0; q < 4; ++q)
        chunk.quarterEnds[q] = bound(chunk.sends & kQuarter[q]);
}

// Tells whether all of b is at or below the plane of all of a, with room for the rounding of pairFaces
// itself.
bool belowPlane(const PatchChunk& a, const PatchChunk& b) {
    if (a.plane == glm::vec3(0)) return false;
    const glm::vec3 normal = glm::abs(a.plane);
    const glm::vec3 top = glm::mix(b.lo, b.hi, glm::greaterThan(a.plane, glm::vec3(0)));
    const float reach = glm::dot(
        glm::max(glm::max(glm::abs(a.lo), glm::abs(a.hi)), glm::max(glm::abs(b.lo), glm::abs(b.hi))), normal);
    const float rounding = 8 * std::numeric_limits<float>::epsilon() * reach;
    return glm::dot(top, a.plane) - a.height + rounding <= a.margin;
}

} // namespace

PatchChunk buildChunk(const Patch* patches, bool rtrad) {
    PatchChunk chunk;
    const float infinity = std::numeric_limits<float>::infinity();
    chunk.sends = 0;
    chunk.lo = glm::vec3(infinity);
    chunk.hi = glm::vec3(-infinity);
    chunk.plane = glm::vec3(0);
    chunk.margin = infinity;
    for (uint32_t j = 0; j < kChunk; ++j)
        addPatch(chunk, j, patches[j], rtrad);
    boundEnds(chunk);
    chunk.height = infinity;
    for (uint32_t j = 0; j < kChunk; ++j)
        if (chunk.sends >> j & 1)
            chunk.height = std::min(chunk.height, glm::dot(patches[j].position, chunk.plane));
    return chunk;
}

std::vector<PatchChunk> buildChunks(const std::vector<Patch>& patches, bool rtrad) {
    std::vector<PatchChunk> chunks;
    chunks.reserve(patches.size() / kChunk);
    for (size_t first = 0; first < patches.size(); first += kChunk)
        chunks.push_back(buildChunk(&patches[first], rtrad));
    return chunks;
}

bool chunksMayFace(const PatchChunk& a, const PatchChunk& b) {
    return a.sends != 0 && b.sends != 0 && !belowPlane(a, b) && !belowPlane(b, a);
}

uint64_t facingRow(const PatchChunk& a, uint32_t row, const PatchChunk& b) {
    if ((a.sends >> row & 1) == 0) return 0;
    const float px = a.px[row], py = a.py[row], pz = a.pz[row];
    const float nx = a.nx[row], ny = a.ny[row], nz = a.nz[row], offset = a.offset[row];
    uint64_t faces = 0;
    for (uint32_t j = 0; j < kChunk; ++j) {
        const float dx = b.px[j] - px, dy = b.py[j] - py, dz = b.pz[j] - pz;
        const bool above = dx * nx + dy * ny + dz * nz > offset;
        const bool below = dx * b.nx[j] + dy * b.ny[j] + dz * b.nz[j] < -b.offset[j];
        faces |= uint64_t(above && below) << j;
    }
    return faces & b.sends;
}

#if defined(__x86_64__)
namespace {

__attribute__((target("avx"))) void facingRowsAvx(const PatchChunk& a, const PatchChunk& b,
                                                  std::array<uint64_t, kChunk>& rows) {
    rows.fill(0);
    const __m256 sign = _mm256_set1_ps(-0.0f);
    for (uint32_t j = 0; j < kChunk; j += 8) {
        const __m256 bx = _mm256_load_ps(&b.px[j]), by = _mm256_load_ps(&b.py[j]),
                     bz = _mm256_load_ps(&b.pz[j]);
        const __m256 mx = _mm256_load_ps(&b.nx[j]), my = _mm256_load_ps(&b.ny[j]),
                     mz = _mm256_load_ps(&b.nz[j]);
        const __m256 limit = _mm256_xor_ps(sign, _mm256_load_ps(&b.offset[j]));
        for (uint32_t i = 0; i < kChunk; ++i) {
            const __m256 dx = _mm256_sub_ps(bx, _mm256_broadcast_ss(&a.px[i]));
            const __m256 dy = _mm256_sub_ps(by, _mm256_broadcast_ss(&a.py[i]));
            const __m256 dz = _mm256_sub_ps(bz, _mm256_broadcast_ss(&a.pz[i]));
            const __m256 up = _mm256_add_ps(_mm256_add_ps(_mm256_mul_ps(dx, _mm256_broadcast_ss(&a.nx[i])),
                                                          _mm256_mul_ps(dy, _mm256_broadcast_ss(&a.ny[i]))),
                                            _mm256_mul_ps(dz, _mm256_broadcast_ss(&a.nz[i])));
            const __m256 down = _mm256_add_ps(_mm256_add_ps(_mm256_mul_ps(dx, mx), _mm256_mul_ps(dy, my)),
                                              _mm256_mul_ps(dz, mz));
            const __m256 both =
                _mm256_and_ps(_mm256_cmp_ps(up, _mm256_broadcast_ss(&a.offset[i]), _CMP_GT_OQ),
                              _mm256_cmp_ps(down, limit, _CMP_LT_OQ));
            rows[i] |= uint64_t(uint32_t(_mm256_movemask_ps(both))) << j;
        }
    }
    for (uint32_t i = 0; i < kChunk; ++i)
        rows[i] &= (a.sends >> i & 1) ? b.sends : 0;
}

} // namespace
#endif

void facingRows(const PatchChunk& a, const PatchChunk& b, std::array<uint64_t, kChunk>& rows) {
#if defined(__x86_64__)
    static const bool avx = __builtin_cpu_supports("avx");
    if (avx) return facingRowsAvx(a, b, rows);
#endif
    for (uint32_t i = 0; i < kChunk; ++i)
        rows[i] = facingRow(a, i, b);
}

} // namespace relume
