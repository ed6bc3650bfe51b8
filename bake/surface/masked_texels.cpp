#include "bake/surface/masked_texels.h"

#include "assets/base/error.h"
#include "assets/base/worker_pool.h"
#include "bake/surface/texel_triangle.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <vector>

// Tracers test the nearest texel of a mask, which is far finer than the lightmap as a rule. A mean that a
// sampler makes of it passes the cutoff or not, and says nothing of the share that is solid. So this is done
// on the CPU, by the tracers' own test in many places of each lightmap texel: the result is the same on all
// devices. The places are drawn in the cells of a grid, as those of a plain grid would all meet the bars of a
// fence, or none.
namespace relume {
namespace {

// Places along an edge of a texel: few where it spans hardly more than one texel of the mask. 256 of them
// tell the share of a texel within 3 %, and errors of neighbours cancel.
constexpr uint32_t kFewPlaces = 8, kManyPlaces = 16;
constexpr double kFewTexels = 2;
// Places along an edge of a triangle: so many per texel of the lightmap, at least and at most. Its texels'
// areas are scaled to what they say, so they are more than those of a texel.
constexpr double kAcrossTexel = 8, kLeastAcross = 8, kMostAcross = 128;

uint32_t bitsOf(float value) {
    return std::bit_cast<uint32_t>(value);
}

// Returns a place drawn in the cell of a grid, in [0, 1).
glm::dvec2 drawnIn(uint32_t column, uint32_t row, uint32_t count, uint32_t key) {
    const uint32_t h = shader::hash32(key ^ shader::hash32(row << 16 | column));
    const glm::dvec2 within((h & 0xffffu) + 0.5, (h >> 16) + 0.5);
    return (glm::dvec2(column, row) + within / 65536.0) / double(count);
}

glm::vec3 weightsFrom(const glm::dvec2& b) {
    return {1.0 - b.x - b.y, b.x, b.y};
}

// Calls work(weights) for places all over a triangle.
template<class Work>
void overPlaces(const WorldMesh& mesh, uint32_t triangle, uint32_t size, const Work& work) {
    const glm::vec2* uv = &mesh.lightmapUv[size_t{triangle} * 3];
    const glm::dvec2 a(uv[1] - uv[0]), b(uv[2] - uv[0]);
    // The edge of a square of twice its area [texels]: slivers would have too many by their longest edge.
    const double across = std::sqrt(std::abs(a.x * b.y - a.y * b.x)) * size;
    const auto count =
        static_cast<uint32_t>(std::clamp(std::ceil(kAcrossTexel * across), kLeastAcross, kMostAcross));
    // Numbers of triangles change when objects move or only some are drawn.
    const uint32_t key = shader::hash32(bitsOf(uv[0].x) ^ shader::hash32(bitsOf(uv[0].y) + bitsOf(uv[1].x)));
    for (uint32_t row = 0; row < count; ++row)
        for (uint32_t column = 0; column < count; ++column) {
            glm::dvec2 place = drawnIn(column, row, count, key);
            // A triangle is half the parallelogram; the other half is folded onto it.
            if (place.x + place.y > 1) place = 1.0 - place;
            work(weightsFrom(place));
        }
}

// Holds what the places in one lightmap texel have found so far.
struct SolidTexel {
    float places = 0.0f, solid = 0.0f; // those in the surface, and those of them that are solid, weighed
    SurfaceColour colour;              // sum over these
    glm::dvec2 own{0.0};               // where the texel's own point lies [texels]
    double distance2 = std::numeric_limits<double>::max(); // of the solid place nearest to it
    uint32_t triangle = 0;                                 // in which that one lies
    glm::vec3 place{0.0f};                                 // weights

    void add(const SurfaceColour& found, float weight) {
        solid += weight;
        colour.albedo += weight * found.albedo;
        colour.emission += weight * found.emission;
    }
};

class SolidSearch {
public:
    SolidSearch(TextureGroup& group, const Scene& scene, const WorldMesh& mesh)
        : group_(group), mesh_(mesh), reader_(scene, mesh) {}

    void run(WorkerPool& pool) {
        group_.solid.assign(group_.window.size(), 1.0f);
        const std::vector<std::vector<uint32_t>> triangles =
            trianglesOfBands(mesh_, mesh_.opaqueCount, mesh_.triangleCount(), group_.window, group_.size);
        pool.run(bandCount(group_.window), [&](uint32_t band) {
            if (!triangles[band].empty()) searchBand(bandRows(group_.window, band), triangles[band]);
        });
    }

private:
    void searchBand(const TexelRows& rows, const std::vector<uint32_t>& triangles) {
        const TexelWindow& w = group_.window;
        const TexelWindow band{w.column, rows.first, w.columns, rows.last - rows.first + 1};
        std::vector<SolidTexel> texels(band.size());
        for (uint32_t y = rows.first; y <= rows.last; ++y)
            for (uint32_t x = w.column; x < w.column + w.columns; ++x)
                if (isMasked(w.index(x, y))) texels[band.index(x, y)].own = ownPlace(w.index(x, y));
        for (const uint32_t t : triangles) {
            const TexelTriangle triangle = texelTriangle(mesh_, t, group_.size);
            if (!(std::abs(triangle.det) > 0)) continue;
            overBounds(triangle, w, rows, [&](const glm::uvec2& texel) {
                const size_t at = w.index(texel.x, texel.y);
                if (isMasked(at) && mesh_.chart[group_.triangle[at] - 1] == mesh_.chart[t] &&
                    triangle.ofTexel(glm::dvec2(texel)) != TexelPart::No)
                    addPlaces(t, triangle, texel, texels[band.index(texel.x, texel.y)]);
            });
        }
        for (uint32_t y = rows.first; y <= rows.last; ++y)
            for (uint32_t x = w.column; x < w.column + w.columns; ++x)
                if (isMasked(w.index(x, y))) finish(w.index(x, y), texels[band.index(x, y)]);
    }

    // Tells whether a texel is a masked triangle's that has a chart.
    bool isMasked(size_t texel) const {
        const uint32_t id = group_.triangle[texel];
        return id > mesh_.opaqueCount && mesh_.chart[id - 1] != kNoChart;
    }

    // Returns the weights of a texel's own point in its triangle: the CIT pass may have moved it there.
    glm::dvec3 ownWeights(size_t texel) const {
        const glm::vec3* p = &mesh_.positions[size_t{group_.triangle[texel] - 1} * 3];
        const glm::dvec3 corner(p[0]), a = glm::dvec3(p[1]) - corner, b = glm::dvec3(p[2]) - corner;
        const glm::dvec3 way = glm::dvec3(group_.pos[texel]) - corner;
        const double aa = glm::dot(a, a), ab = glm::dot(a, b), bb = glm::dot(b, b);
        const double wa = glm::dot(way, a), wb = glm::dot(way, b), det = aa * bb - ab * ab;
        if (!(det > 0)) return glm::dvec3(1.0 / 3.0);
        const glm::dvec2 weights = glm::dvec2(wa * bb - wb * ab, wb * aa - wa * ab) / det;
        return {1.0 - weights.x - weights.y, weights};
    }
    glm::dvec2 ownPlace(size_t texel) const {
        const glm::dvec3 w = ownWeights(texel);
        const glm::vec2* uv = &mesh_.lightmapUv[size_t{group_.triangle[texel] - 1} * 3];
        return (w.x * glm::dvec2(uv[0]) + w.y * glm::dvec2(uv[1]) + w.z * glm::dvec2(uv[2])) *
               double(group_.size);
    }

    // Adds those places of a texel that lie in a triangle.
    void addPlaces(uint32_t t, const TexelTriangle& triangle, const glm::uvec2& texel, SolidTexel& found) {
        const glm::dvec2 zero = triangle.weights({0, 0});
        const auto span = [&](const glm::dvec2& at) {
            const glm::dvec2 b = triangle.weights(at) - zero;
            return reader_.maskTexels(t, {-b.x - b.y, b});
        };
        const bool fine = std::max(span({1, 0}), span({0, 1})) > kFewTexels;
        const uint32_t count = fine ? kManyPlaces : kFewPlaces;
        const float weight = 1.0f / static_cast<float>(count * count); // exact: its sums are, too
        const uint32_t key = shader::hash32(texel.y * group_.size + texel.x);
        for (uint32_t row = 0; row < count; ++row)
            for (uint32_t column = 0; column < count; ++column) {
                const glm::dvec2 at = glm::dvec2(texel) + drawnIn(column, row, count, key);
                if (!triangle.has(at)) continue;
                found.places += weight;
                const glm::vec3 place = weightsFrom(triangle.weights(at));
                if (!reader_.isSolid(t, place)) continue;
                found.add(reader_.colourAt(t, place), weight);
                const glm::dvec2 way = at - found.own;
                if (glm::dot(way, way) >= found.distance2) continue;
                found.distance2 = glm::dot(way, way);
                found.triangle = t;
                found.place = place;
            }
    }

    void finish(size_t texel, SolidTexel& found) {
        const uint32_t own = group_.triangle[texel] - 1;
        const auto weights = glm::vec3(ownWeights(texel));
        const bool isSolid = reader_.isSolid(own, weights);
        if (isSolid && found.solid == 0.0f) {
            // The texel's own point counts as one place where the others have missed what is there.
            constexpr float kOnePlace = 1.0f / (kManyPlaces * kManyPlaces);
            found.places += kOnePlace;
            found.add(reader_.colourAt(own, weights), kOnePlace);
        }
        if (found.solid == 0.0f) return clear(texel);
        group_.solid[texel] = std::min(found.solid / found.places, 1.0f);
        group_.mat[texel] = found.colour.albedo / found.solid;
        group_.emission[texel] = found.colour.emission / found.solid;
        if (!isSolid) moveTo(texel, found.triangle, found.place);
    }

    void clear(size_t texel) {
        group_.triangle[texel] = 0;
        group_.solid[texel] = 0.0f;
        group_.pos[texel] = group_.nrm[texel] = group_.mat[texel] = group_.emission[texel] = glm::vec4(0.0f);
    }

    void moveTo(size_t texel, uint32_t triangle, const glm::vec3& weights) {
        const glm::vec3* p = &mesh_.positions[size_t{triangle} * 3];
        const glm::vec3* n = &mesh_.normals[size_t{triangle} * 3];
        const glm::vec3 normal = n[0] * weights.x + n[1] * weights.y + n[2] * weights.z;
        const float length = glm::length(normal);
        group_.triangle[texel] = 1 + triangle;
        group_.pos[texel] = glm::vec4(p[0] + ((p[1] - p[0]) * weights.y + (p[2] - p[0]) * weights.z), 1.0f);
        group_.nrm[texel] = glm::vec4(length > 0.0f ? normal / length : glm::vec3(0.0f), 0.0f);
    }

    TextureGroup& group_;
    const WorldMesh& mesh_;
    const SurfaceReader reader_;
};

} // namespace

SolidPart solidPart(const SurfaceReader& reader, const WorldMesh& mesh, uint32_t triangle, uint32_t size) {
    SolidPart part;
    uint32_t places = 0, solid = 0;
    float nearest = std::numeric_limits<float>::max();
    overPlaces(mesh, triangle, size, [&](const glm::vec3& weights) {
        ++places;
        if (!reader.isSolid(triangle, weights)) return;
        ++solid;
        const SurfaceColour colour = reader.colourAt(triangle, weights);
        part.colour.albedo += colour.albedo;
        part.colour.emission += colour.emission;
        const glm::vec3 way = weights - 1.0f / 3.0f;
        if (glm::dot(way, way) >= nearest) return;
        nearest = glm::dot(way, way);
        part.place = weights;
    });
    if (solid == 0) return part;
    part.share = static_cast<float>(solid) / static_cast<float>(places);
    part.colour.albedo /= static_cast<float>(solid);
    part.colour.emission /= static_cast<float>(solid);
    return part;
}

float solidShare(const SurfaceReader& reader, const WorldMesh& mesh, uint32_t triangle, uint32_t size) {
    uint32_t places = 0, solid = 0;
    overPlaces(mesh, triangle, size, [&](const glm::vec3& weights) {
        ++places;
        solid += reader.isSolid(triangle, weights) ? 1u : 0u;
    });
    return static_cast<float>(solid) / static_cast<float>(places);
}

void findSolidTexels(TextureGroup& group, const Scene& scene, const WorldMesh& mesh, WorkerPool& pool) {
    SolidSearch(group, scene, mesh).run(pool);
}

} // namespace relume
