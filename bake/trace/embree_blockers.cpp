#include "bake/trace/embree_blockers.h"

#include <algorithm>
#include <cmath>
#include <limits>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace relume {

using shader::kChunk;

namespace {

constexpr uint32_t kIdleMax =
    6; // rows without a hit after which a triangle is forgotten: the view of it has moved on

// A segment from the origin along d crosses the triangle if all four n . d > limit: three for its edges, one
// for its plane.
struct Pyramid {
    std::array<glm::vec3, 4> normal;
    std::array<float, 4> limit;
};

// Makes the pyramid; returns false if the origin lies in the triangle's plane, as near as rounding lets tell.
bool makePyramid(const glm::vec3* corner, const glm::vec3& origin, Pyramid& pyramid) {
    constexpr float kPyramidRounding = 16 * std::numeric_limits<float>::epsilon();
    const glm::vec3 a = corner[0] - origin, b = corner[1] - origin, c = corner[2] - origin;
    const glm::vec3 plane = glm::cross(corner[1] - corner[0], corner[2] - corner[0]);
    const float distance = glm::dot(plane, a);
    const float side = distance < 0 ? -1.0f : 1.0f;
    const glm::vec3 far = glm::max(glm::abs(a), glm::max(glm::abs(b), glm::abs(c))) + glm::abs(origin);
    const float reach = far.x + far.y + far.z;
    pyramid.normal = {side * glm::cross(a, b), side * glm::cross(b, c), side * glm::cross(c, a),
                      side * plane};
    for (size_t k = 0; k < 4; ++k) {
        const glm::vec3 n = glm::abs(pyramid.normal[k]);
        pyramid.limit[k] = kPyramidRounding * reach * (n.x + n.y + n.z);
    }
    const bool clear = std::abs(distance) > pyramid.limit[3];
    pyramid.limit[3] += std::abs(distance);
    return clear;
}

uint64_t insideAny(const Pyramid& pyramid, const glm::vec3& origin, const PatchChunk& b) {
    uint64_t inside = 0;
    for (uint32_t j = 0; j < kChunk; ++j) {
        const glm::vec3 d = glm::vec3(b.ex[j], b.ey[j], b.ez[j]) - origin;
        bool in = true;
        for (size_t k = 0; k < 4; ++k)
            in = in && glm::dot(pyramid.normal[k], d) > pyramid.limit[k];
        inside |= uint64_t(in) << j;
    }
    return inside;
}

#if defined(__x86_64__)
__attribute__((target("avx"))) uint64_t insideAvx(const Pyramid& pyramid, const glm::vec3& origin,
                                                  const PatchChunk& b) {
    const __m256 ox = _mm256_set1_ps(origin.x), oy = _mm256_set1_ps(origin.y), oz = _mm256_set1_ps(origin.z);
    uint64_t inside = 0;
    for (uint32_t j = 0; j < kChunk; j += 8) {
        const __m256 dx = _mm256_sub_ps(_mm256_load_ps(&b.ex[j]), ox);
        const __m256 dy = _mm256_sub_ps(_mm256_load_ps(&b.ey[j]), oy);
        const __m256 dz = _mm256_sub_ps(_mm256_load_ps(&b.ez[j]), oz);
        __m256 in = _mm256_castsi256_ps(_mm256_set1_epi32(-1));
        for (size_t k = 0; k < 4; ++k) {
            const glm::vec3& n = pyramid.normal[k];
            const __m256 h = _mm256_add_ps(
                _mm256_add_ps(_mm256_mul_ps(dx, _mm256_set1_ps(n.x)), _mm256_mul_ps(dy, _mm256_set1_ps(n.y))),
                _mm256_mul_ps(dz, _mm256_set1_ps(n.z)));
            in = _mm256_and_ps(in, _mm256_cmp_ps(h, _mm256_set1_ps(pyramid.limit[k]), _CMP_GT_OQ));
        }
        inside |= uint64_t(uint32_t(_mm256_movemask_ps(in))) << j;
    }
    return inside;
}
#endif

uint64_t inside(const Pyramid& pyramid, const glm::vec3& origin, const PatchChunk& b) {
#if defined(__x86_64__)
    static const bool avx = __builtin_cpu_supports("avx");
    if (avx) return insideAvx(pyramid, origin, b);
#endif
    return insideAny(pyramid, origin, b);
}

} // namespace

void Blockers::add(uint32_t triangle) {
    for (uint32_t k = 0; k < count_; ++k)
        if (entries_[k].triangle == triangle) return;
    if (count_ < kMax) {
        entries_[count_++] = {triangle, 0};
        return;
    }
    *std::max_element(entries_.begin(), entries_.end(),
                      [](const Entry& x, const Entry& y) { return x.idle < y.idle; }) = {triangle, 0};
}

uint64_t Blockers::stopped(const glm::vec3& origin, const PatchChunk& b, uint64_t asked) {
    uint64_t hidden = 0;
    for (uint32_t k = 0; k < count_ && (asked & ~hidden) != 0;) {
        Entry& entry = entries_[k];
        Pyramid pyramid;
        uint64_t found = 0;
        if (makePyramid(positions_ + size_t(entry.triangle) * 3, origin, pyramid))
            found = inside(pyramid, origin, b) & asked & ~hidden;
        hidden |= found;
        entry.idle = found != 0 ? 0 : entry.idle + 1;
        if (entry.idle > kIdleMax) {
            entry = entries_[--count_];
        } else {
            ++k;
        }
    }
    return hidden;
}

} // namespace relume
