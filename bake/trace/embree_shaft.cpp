#include "bake/trace/embree_shaft.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace relume {

using shader::kChunk;

namespace {

constexpr float kShaftRounding =
    16 * std::numeric_limits<float>::epsilon(); // of sums of a few products, times their reach

// So many nodes are looked at before giving up: by then the search costs as much as the rays it could save.
constexpr uint32_t kVisitsMax = 256;

float largest(const glm::vec3& v) {
    return std::max({v.x, v.y, v.z});
}

} // namespace

Shaft::Shaft(const PatchChunk& a, const EndBox& endsA, const PatchChunk& b, const EndBox& endsB)
    : a_(a), b_(b) {
    bounds_ = {glm::min(endsA.lo, endsB.lo), glm::max(endsA.hi, endsB.hi)};
    reach_ = largest(glm::max(glm::abs(bounds_.lo), glm::abs(bounds_.hi)));
    nx_.fill(0), ny_.fill(0), nz_.fill(0), d_.fill(1);
    addPlanes(endsA, endsB);
}

// Adds the hull's planes. Seen along an axis both boxes are rectangles. A line through the same corner of
// both bounds their hull if its normal points the corner's way; there are at most two such lines.
void Shaft::addPlanes(const EndBox& a, const EndBox& b) {
    uint32_t count = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        for (uint32_t corner = 0; corner < 4; ++corner) {
            const float su = corner & 1 ? 1.0f : -1.0f, sv = corner & 2 ? 1.0f : -1.0f;
            const glm::vec2 ca(su > 0 ? a.hi[u] : a.lo[u], sv > 0 ? a.hi[v] : a.lo[v]);
            const glm::vec2 cb(su > 0 ? b.hi[u] : b.lo[u], sv > 0 ? b.hi[v] : b.lo[v]);
            glm::vec2 normal(cb.y - ca.y, ca.x - cb.x);
            if (normal.x * su < 0) normal = -normal;
            if (normal.x * su <= 0 || normal.y * sv <= 0 || count == kPlanes) continue;
            normal /= std::abs(normal.x) + std::abs(normal.y);
            const float d = std::max(normal.x * ca.x + normal.y * ca.y, normal.x * cb.x + normal.y * cb.y);
            float* const n[3] = {nx_.data(), ny_.data(), nz_.data()};
            n[u][count] = normal.x;
            n[v][count] = normal.y;
            d_[count++] = d + kShaftRounding * reach_;
        }
    }
}

// Tells whether the hull misses a box: a plane is missed by all of the box if it is by the box's corner
// deepest below.
bool Shaft::missesBox(const glm::vec3& lo, const glm::vec3& hi) const {
    if (lo.x > bounds_.hi.x || lo.y > bounds_.hi.y || lo.z > bounds_.hi.z) return true;
    if (hi.x < bounds_.lo.x || hi.y < bounds_.lo.y || hi.z < bounds_.lo.z) return true;
    int outside = 0;
    for (uint32_t k = 0; k < kPlanes; ++k) {
        const float deepest = std::min(nx_[k] * lo.x, nx_[k] * hi.x) +
                              std::min(ny_[k] * lo.y, ny_[k] * hi.y) + std::min(nz_[k] * lo.z, nz_[k] * hi.z);
        outside |= deepest > d_[k];
    }
    return outside != 0;
}

bool Shaft::missesTriangle(const shader::BvhTriangle& t) const {
    if (missesBox(glm::min(t.p0, glm::min(t.p1, t.p2)), glm::max(t.p0, glm::max(t.p1, t.p2)))) return true;
    int outside = 0;
    for (uint32_t k = 0; k < kPlanes; ++k) {
        const float h0 = nx_[k] * t.p0.x + ny_[k] * t.p0.y + nz_[k] * t.p0.z;
        const float h1 = nx_[k] * t.p1.x + ny_[k] * t.p1.y + nz_[k] * t.p1.z;
        const float h2 = nx_[k] * t.p2.x + ny_[k] * t.p2.y + nz_[k] * t.p2.z;
        outside |= std::min(h0, std::min(h1, h2)) > d_[k];
    }
    if (outside != 0) return true;
    // If all ends lie on one side of its plane, as for the wall that the patches themselves lie on, no ray
    // crosses it.
    const glm::vec3 normal = glm::cross(t.p1 - t.p0, t.p2 - t.p0);
    const float height = glm::dot(normal, t.p0);
    const float size = std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z);
    const float margin = kShaftRounding * size * std::max(reach_, largest(glm::abs(t.p0)));
    float low = std::numeric_limits<float>::infinity(), high = -low;
    for (const PatchChunk* chunk : {&a_, &b_}) {
        for (uint32_t j = 0; j < kChunk; ++j) {
            const float h = normal.x * chunk->ex[j] + normal.y * chunk->ey[j] + normal.z * chunk->ez[j];
            low = h < low ? h : low;
            high = h > high ? h : high;
        }
    }
    return low > height + margin || high < height - margin;
}

bool Shaft::isOpen(const Bvh& bvh) const {
    std::array<int, shader::kBvhDepth> stack;
    uint32_t top = 0, visits = 0;
    int current = 0;
    for (;;) {
        if (current < 0) {
            const uint32_t first = uint32_t(~current) >> 3, count = uint32_t(~current) & 7;
            for (uint32_t i = first; i < first + count; ++i)
                if (!missesTriangle(bvh.triangles[i])) return false;
        } else {
            if (++visits > kVisitsMax) return false;
            const shader::BvhNode& node = bvh.nodes[size_t(current)];
            const BvhBox box0 = childBox(node, 0), box1 = childBox(node, 1);
            const bool in0 = !missesBox(box0.lo, box0.hi), in1 = !missesBox(box1.lo, box1.hi);
            if (in0 && in1) stack[top++] = node.child1;
            if (in0 || in1) {
                current = in0 ? node.child0 : node.child1;
                continue;
            }
        }
        if (top == 0) return true;
        current = stack[--top];
    }
}

} // namespace relume
