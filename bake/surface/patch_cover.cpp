#include "bake/surface/patch_cover.h"

#include "assets/base/error.h"
#include "assets/base/worker_pool.h"
#include "bake/surface/known_covers.h"
#include "bake/surface/texel_triangle.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace relume {
namespace {

using shader::kCoverCells;
using shader::kCoverEdge;
using shader::kCoverWhole;
using shader::kNoPatch;
using shader::kRimPlaces;

constexpr uint32_t kCells = kCoverEdge * kCoverEdge;
constexpr uint16_t kRim = (1u << kRimPlaces) - 1;
constexpr uint16_t kDone = 1u << kRimPlaces; // in place of a rim: the cover is known, and has not all of it
// Edges are shortened by this share on both sides: what lies on the very edge of a texel may lie in a wall
// that stands there.
constexpr float kInset = 1.0f / 256.0f;
// Points keep to where the surface is no farther from the patch's plane, and from where the patch's own
// triangle would have it, than this share of the texel: beyond, it bends or is stretched.
constexpr float kMostBend = 0.05f;
// Below the surface no ray may start: it may rise by no more than this share of the patch's offset.
constexpr float kMostRise = 0.5f;
// Normals that differ by more than some 25 degrees are another surface's.
constexpr float kLeastCosine = 0.9f;

class CoverBuilder {
public:
    CoverBuilder(PatchSet& set, const TextureGroup& group, std::span<const TriangleFrame> frames,
                 const KnownCovers* known)
        : set_(set), group_(group), frames_(frames), known_(known), rims_(set.scene.patches.size(), 0) {
        ASSERT(set.covers.size() == set.scene.patches.size()); // and all are empty
    }

    // Texels are worked on in bands of rows, each by one thread, so that nobody else writes to their covers.
    // What triangles add to a cover does not depend on their order.
    void run(WorkerPool* pool) {
        const TexelWindow& w = group_.window;
        const WorldMesh& mesh = set_.scene.mesh;
        const std::vector<std::vector<uint32_t>> triangles =
            trianglesOfBands(mesh, 0, mesh.opaqueCount, w, group_.size);
        runWatched(pool, "patches", bandCount(w), [&](uint32_t band) {
            const TexelRows rows = bandRows(w, band);
            for (uint32_t y = rows.first; known_ && y <= rows.last; ++y)
                for (uint32_t x = w.column; x < w.column + w.columns; ++x)
                    takeKnown({x, y});
            for (const uint32_t t : triangles[band])
                cover(t, rows);
            for (uint32_t y = rows.first; y <= rows.last; ++y)
                for (uint32_t x = w.column; x < w.column + w.columns; ++x)
                    finish({x, y});
        });
        set_.reach.assign(set_.chunkCount(), 0.0f);
        constexpr uint32_t kChunks = 256; // that a thread works on at a time
        runWatched(pool, "patches", (set_.chunkCount() + kChunks - 1) / kChunks, [&](uint32_t portion) {
            const uint32_t end = std::min(set_.chunkCount(), (portion + 1) * kChunks);
            for (uint32_t chunk = portion * kChunks; chunk < end; ++chunk)
                set_.reach[chunk] = chunkReach(set_, chunk);
        });
    }

private:
    // Marks the patch of a texel as done where its cover is known: its cells are there, and its rim is whole
    // or cannot become so.
    void takeKnown(glm::uvec2 texel) {
        const uint32_t patch = set_.scene.texelToPatch[group_.window.index(texel.x, texel.y)];
        const uint32_t former = patch == kNoPatch ? kNoPatch : known_->of(set_, patch);
        if (former == kNoPatch) return;
        const uint32_t cells = known_->former.coverCells[former];
        set_.covers[patch].cells = cells & kCoverCells;
        rims_[patch] = (cells & kCoverWhole) != 0 ? kRim : kDone;
    }

    // Completes the cover of a texel's patch, of which all triangles have been seen.
    void finish(glm::uvec2 texel) {
        const uint32_t patch = set_.scene.texelToPatch[group_.window.index(texel.x, texel.y)];
        if (patch == kNoPatch || !covers(patch)) return;
        const uint32_t own = ownTriangle(texel.x, texel.y);
        const TriangleFrame& frame = frames_[own];
        shader::PatchCover& c = set_.covers[patch];
        const auto whole = static_cast<float>(shader::kCoverPlaces);
        const glm::vec2 place = placeOf(patch, own, texel);
        c.du = (1.0f - 2.0f * kInset) * frame.du;
        c.dv = (1.0f - 2.0f * kInset) * frame.dv;
        c.place = static_cast<uint32_t>(std::lround(place.x * whole)) |
                  static_cast<uint32_t>(std::lround(place.y * whole)) << 16;
        if (c.cells == kCoverCells && rims_[patch] == kRim) c.cells |= kCoverWhole;
        set_.coverCells[patch] = c.cells;
    }

    bool covers(uint32_t patch) const { return set_.covers[patch].cells != 0; }
    uint32_t ownTriangle(uint32_t x, uint32_t y) const {
        return group_.triangle[group_.window.index(x, y)] - 1;
    }

    // Returns where a corner of a triangle lies in the lightmap [texels].
    glm::dvec2 texelsOf(uint32_t t, size_t k) const {
        return glm::dvec2(set_.scene.mesh.lightmapUv[size_t{t} * 3 + k]) * double(group_.size);
    }

    TexelTriangle texelTriangle(uint32_t t) const {
        return relume::texelTriangle(set_.scene.mesh, t, group_.size);
    }

    // Returns where the patch's own point lies in its texel.
    glm::vec2 placeOf(uint32_t patch, uint32_t triangle, glm::uvec2 texel) const {
        const glm::dvec3 du(frames_[triangle].du), dv(frames_[triangle].dv);
        const glm::dvec3 way = glm::dvec3(set_.scene.patches[patch].position) -
                               glm::dvec3(set_.scene.mesh.positions[size_t{triangle} * 3]);
        const double uu = glm::dot(du, du), uv = glm::dot(du, dv), vv = glm::dot(dv, dv);
        const double det = uu * vv - uv * uv, a = glm::dot(way, du), b = glm::dot(way, dv);
        if (!(det > 0)) return glm::vec2(0.5f);
        const glm::dvec2 at = texelsOf(triangle, 0) + glm::dvec2(a * vv - b * uv, b * uu - a * uv) / det;
        const glm::dvec2 place = glm::clamp(at - glm::dvec2(texel), glm::dvec2(0.0), glm::dvec2(1.0));
        // A point that was not moved there lies in the middle, whatever the position has lost by rounding.
        constexpr double kMiddle = 1e-3;
        if (std::abs(place.x - 0.5) < kMiddle && std::abs(place.y - 0.5) < kMiddle) return glm::vec2(0.5f);
        return glm::vec2(place);
    }

    // Adds what a triangle covers in these rows to the patches of its chart.
    void cover(uint32_t t, const TexelRows& rows) {
        const TexelTriangle triangle = texelTriangle(t);
        if (!(std::abs(triangle.det) > 0)) return;
        overBounds(triangle, group_.window, rows,
                   [&](const glm::uvec2& texel) { coverTexel(t, triangle, texel); });
    }

    void coverTexel(uint32_t t, const TexelTriangle& triangle, glm::uvec2 texel) {
        const uint32_t patch = set_.scene.texelToPatch[group_.window.index(texel.x, texel.y)];
        if (patch == kNoPatch || set_.scene.patchChart[patch] != set_.scene.mesh.chart[t]) return;
        const uint32_t own = ownTriangle(texel.x, texel.y);
        if (own >= set_.scene.mesh.opaqueCount) return;
        shader::PatchCover& c = set_.covers[patch];
        if (rims_[patch] == kDone || (c.cells == kCoverCells && rims_[patch] == kRim)) return;
        const glm::dvec2 corner(texel);
        const TexelPart part = triangle.ofTexel(corner);
        if (part == TexelPart::No) return;
        const auto inside = [&](double x, double y) { return triangle.has(corner + glm::dvec2(x, y)); };
        if (t == own &&
            (part == TexelPart::All || (inside(0, 0) && inside(1, 0) && inside(0, 1) && inside(1, 1)))) {
            c.cells = kCoverCells;
            rims_[patch] = kRim;
            return;
        }
        const auto goesOn = [&](const glm::vec2& place) {
            const glm::dvec2 at = corner + glm::dvec2(place);
            return triangle.has(at) && (t == own || continues(patch, own, t, triangle, at));
        };
        for (uint32_t cell = 0; cell < kCells; ++cell)
            if ((c.cells >> cell & 1u) == 0 && goesOn(shader::cellPlace(cell))) c.cells |= 1u << cell;
        for (uint32_t i = 0; i < kRimPlaces; ++i)
            if ((rims_[patch] >> i & 1u) == 0 && goesOn(shader::rimPlace(i)))
                rims_[patch] |= static_cast<uint16_t>(1u << i);
    }

    // Tells whether triangle t goes on, at a place in the lightmap [texels], where the patch's own one would.
    bool continues(uint32_t patch, uint32_t own, uint32_t t, const TexelTriangle& triangle,
                   const glm::dvec2& at) const {
        const shader::Patch& p = set_.scene.patches[patch];
        if (glm::dot(frames_[t].normal, p.normal) < kLeastCosine) return false;
        const auto pointOf = [&](uint32_t of, const TexelTriangle& texels) {
            const glm::vec3* corner = &set_.scene.mesh.positions[size_t{of} * 3];
            const glm::vec2 b(texels.weights(at));
            return corner[0] + b.x * (corner[1] - corner[0]) + b.y * (corner[2] - corner[0]);
        };
        const glm::vec3 there = pointOf(t, triangle), wanted = pointOf(own, texelTriangle(own));
        const float size = std::min(glm::length(frames_[own].du), glm::length(frames_[own].dv));
        return glm::dot(there - p.position, p.normal) <= kMostRise * p.offset &&
               glm::distance(there, wanted) <= kMostBend * size;
    }

    PatchSet& set_;
    const TextureGroup& group_;
    std::span<const TriangleFrame> frames_;
    const KnownCovers* known_;
    std::vector<uint16_t> rims_; // per patch: a bit for each place on the texel's edge that is covered
};

} // namespace

void addCovers(PatchSet& set, const TextureGroup& group, std::span<const TriangleFrame> frames,
               WorkerPool* pool, const KnownCovers* known) {
    CoverBuilder(set, group, frames, known).run(pool);
}

float coverReach(const shader::PatchCover& cover) {
    return cover.cells == 0 ? 0.0f : glm::length(cover.du) + glm::length(cover.dv);
}

float chunkReach(const PatchSet& set, uint32_t chunk) {
    float reach = 0.0f;
    for (size_t i = size_t{chunk} * shader::kChunk; i < size_t{chunk + 1} * shader::kChunk; ++i)
        reach = std::max(reach, coverReach(set.covers[i]));
    return reach;
}

} // namespace relume
