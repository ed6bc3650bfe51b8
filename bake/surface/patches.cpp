#include "bake/surface/patches.h"

#include "assets/base/error.h"
#include "assets/base/watch.h"
#include "assets/base/worker_pool.h"
#include "bake/surface/alpha_tables.h"
#include "bake/surface/known_covers.h"
#include "bake/surface/masked_texels.h"
#include "bake/surface/patch_cover.h"
#include "bake/surface/patch_material.h"
#include "bake/surface/surface_reader.h"
#include "bake/surface/triangle_frame.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <utility>

namespace relume {
namespace {

using shader::kChunk;
using shader::kNoPatch;

constexpr float kMaxAlbedo = 0.98f; // times the reflectivity: above, the iteration hardly ends
constexpr float kOffset = 1e-4f;    // of a texel's size, along the normal
constexpr float kFloatError =
    8.0f * 0.5f * std::numeric_limits<float>::epsilon(); // of a coordinate after interpolation
// A chart's texels are scaled to the area of its triangles, but never up by more than this: a chart two
// texels wide may catch one centre in each direction; where more is missing another chart was drawn over it.
constexpr float kMaxAreaCorrection = 4.0f;

constexpr const char* kPatchesPhase = "patches"; // that a watch hears of
// What a thread works on at a time.
constexpr uint32_t kTrianglesEach = 4096, kChunksEach = 256;

// Everything about one patch, before it is put into its place.
struct NewPatch {
    shader::Patch patch{};
    shader::PatchEdges edges{};
    glm::vec4 albedo{0.0f}, emission{0.0f}; // for factors of 1
    uint32_t chart = kNoChart, material = 0, instance = 0;
};

struct ThinChart {
    uint32_t triangle = 0; // the one with the largest solid part
    float area = 0.0f;     // [m^2], of all that is solid in the chart
};

class PatchBuilder {
public:
    PatchBuilder(const Scene& scene, WorldMesh mesh, const TextureGroup& group, const PatchDesc& desc)
        : scene_(scene), materials_(scene.materials), group_(group), rtrad_(desc.rtrad), part_(desc.part),
          pool_(desc.pool), reader_(scene, set_.scene.mesh) {
        if (!rtrad_) set_.maxAlbedo = kMaxAlbedo / std::max(desc.reflectivity, 1e-6f);
        materials_.emplace_back(); // glTF's default material
        set_.scene.mesh = std::move(mesh);
        set_.scene.size = group.size;
        set_.scene.rtrad = desc.rtrad;
        const WorldMesh& m = set_.scene.mesh;
        frames_.resize(m.triangleCount());
        texelArea_.resize(m.triangleCount());
        inPortions(m.triangleCount(), kTrianglesEach, [&](uint32_t t) {
            frames_[t] = triangleFrame(m, t, group.size);
            texelArea_[t] = glm::length(glm::cross(frames_[t].du, frames_[t].dv));
        });
        surveyCharts();
    }

    PatchSet build(const KnownCovers* known) {
        const TexelWindow& w = group_.window;
        ASSERT(w.column % kTileTexels == 0 && w.row % kTileTexels == 0);
        set_.scene.texelToPatch.assign(w.size(), kNoPatch);
        const uint32_t rows = (w.rows + kTileTexels - 1) / kTileTexels; // of tiles
        std::vector<uint32_t> firsts(size_t{rows} + 1, 0);              // patch of each
        runWatched(pool_, kPatchesPhase, rows, [&](uint32_t row) { firsts[row + 1] = countRow(row); });
        std::partial_sum(firsts.begin(), firsts.end(), firsts.begin());
        set_.count = firsts[rows];
        if (set_.count == 0 && !part_) {
            throw Error("the lightmap covers no texel: its UVs are degenerate; run 'relume unwrap' or leave "
                        "out --no-unwrap");
        }
        const uint32_t padded = (set_.count + kChunk - 1) / kChunk * kChunk;
        resize(padded);
        runWatched(pool_, kPatchesPhase, rows, [&](uint32_t row) { fillRow(row, firsts[row]); });
        NewPatch padding;
        padding.instance = static_cast<uint32_t>(scene_.instances.size());
        for (uint32_t i = set_.count; i < padded; ++i)
            put(i, padding);
        findMiddles();
        if (!rtrad_) addCovers(set_, group_, frames_, pool_, known);
        applyMaterials(set_, scene_.materials, pool_);
        set_.bounds.resize(set_.chunkCount());
        inPortions(set_.chunkCount(), kChunksEach,
                   [&](uint32_t chunk) { set_.bounds[chunk] = chunkBounds(set_, chunk); });
        addHitTriangles();
        addAlphaTables(scene_, set_.scene);
        return std::move(set_);
    }

private:
    // Calls work(i) for each i below count, so many at a time on each thread.
    template<class Work>
    void inPortions(uint32_t count, uint32_t portion, const Work& work) const {
        runWatched(pool_, kPatchesPhase, (count + portion - 1) / portion, [&](uint32_t number) {
            const uint32_t end = std::min(count, (number + 1) * portion);
            for (uint32_t i = number * portion; i < end; ++i)
                work(i);
        });
    }

    // Finds how much each chart's texels must be scaled to have its area, and which charts no texel centre
    // hits.
    void surveyCharts() {
        const WorldMesh& m = set_.scene.mesh;
        const std::vector<float> solidAreas = findSolidAreas();
        std::vector<double> area(m.chartCount, 0.0), texels(m.chartCount, 0.0);
        std::vector<uint32_t> largest(m.chartCount, kNoPatch);
        for (uint32_t t = 0; t < m.triangleCount(); ++t) {
            const uint32_t chart = m.chart[t];
            if (chart == kNoChart || (isMasked(t) && solidAreas[t] == 0.0f)) continue; // all hole
            area[chart] += solidAreas[t];
            if (largest[chart] == kNoPatch || solidAreas[t] > solidAreas[largest[chart]]) largest[chart] = t;
        }
        // In the texels' order: a window then sums up a chart as the whole lightmap does, to the bit.
        for (size_t i = 0; i < group_.triangle.size(); ++i) {
            const uint32_t id = group_.triangle[i];
            if (id == 0 || m.chart[id - 1] == kNoChart) continue;
            texels[m.chart[id - 1]] += texelArea_[id - 1] * group_.solidAt(i);
        }
        areaScale_.assign(m.chartCount, 1.0f);
        thin_.resize(size_t{tileColumns()} * ((group_.window.rows + kTileTexels - 1) / kTileTexels));
        for (uint32_t chart = 0; chart < m.chartCount; ++chart) {
            if (texels[chart] > 0.0 && area[chart] > 0.0) {
                const auto scale = static_cast<float>(area[chart] / texels[chart]);
                if (!rtrad_) areaScale_[chart] = std::min(scale, kMaxAreaCorrection);
            } else if (!rtrad_ && largest[chart] != kNoPatch) {
                const glm::uvec2 texel = texelOf(centroidUv(largest[chart]));
                if (group_.window.has(texel.x, texel.y))
                    thin_[tileOf(texel.x, texel.y)].push_back(
                        {largest[chart], static_cast<float>(area[chart])});
            }
        }
    }

    // Returns the area of each triangle without its holes [m^2].
    std::vector<float> findSolidAreas() const {
        const WorldMesh& m = set_.scene.mesh;
        std::vector<float> areas(m.triangleCount());
        inPortions(m.triangleCount(), kTrianglesEach, [&](uint32_t t) {
            areas[t] = frames_[t].area;
            if (isMasked(t) && m.chart[t] != kNoChart) areas[t] *= solidShare(reader_, m, t, group_.size);
        });
        return areas;
    }
    bool isMasked(uint32_t triangle) const { // RTRad knows no holes
        return !rtrad_ && triangle >= set_.scene.mesh.opaqueCount;
    }

    // Counts the window's tiles along a row.
    uint32_t tileColumns() const { return (group_.window.columns + kTileTexels - 1) / kTileTexels; }
    size_t tileOf(uint32_t x, uint32_t y) const {
        const TexelWindow& w = group_.window;
        return size_t{(y - w.row) / kTileTexels} * tileColumns() + (x - w.column) / kTileTexels;
    }

    glm::vec2 centroidUv(uint32_t triangle) const {
        const glm::vec2* t = &set_.scene.mesh.lightmapUv[size_t{triangle} * 3];
        return (t[0] + t[1] + t[2]) / 3.0f;
    }
    glm::uvec2 texelOf(glm::vec2 uv) const {
        const glm::vec2 p = glm::clamp(glm::floor(uv * static_cast<float>(group_.size)), glm::vec2(0.0f),
                                       glm::vec2(static_cast<float>(group_.size - 1)));
        return glm::uvec2(p);
    }

    // Makes all that is there for each patch: to clear gigabytes takes one thread longer than all to fill
    // them.
    void resize(uint32_t count) {
        const std::array<std::function<void()>, 11> all = {
            [&] { set_.scene.patches.resize(count); },
            [&] { set_.edges.resize(count); },
            [&] { set_.covers.resize(rtrad_ ? 0 : count); },
            [&] { set_.albedoPattern.resize(count); },
            [&] { set_.emissionPattern.resize(count); },
            [&] { set_.albedo.resize(count); },
            [&] { set_.emission.resize(count); },
            [&] { set_.coverCells.resize(rtrad_ ? 0 : count); },
            [&] { set_.scene.patchChart.resize(count); },
            [&] { set_.material.resize(count); },
            [&] { set_.instance.resize(count); },
        };
        runWatched(pool_, kPatchesPhase, static_cast<uint32_t>(all.size()),
                   [&](uint32_t which) { all[which](); });
    }

    void put(uint32_t index, const NewPatch& p) {
        set_.scene.patches[index] = p.patch;
        set_.scene.patchChart[index] = p.chart;
        set_.edges[index] = p.edges;
        set_.albedoPattern[index] = p.albedo;
        set_.emissionPattern[index] = p.emission;
        set_.material[index] = p.material;
        set_.instance[index] = p.instance;
    }

    // Calls work(texel, triangle) for each texel of a tile that has a patch.
    template<class Work>
    void overTexels(glm::uvec2 first, const Work& work) const {
        const TexelWindow& w = group_.window;
        for (uint32_t y = first.y; y < std::min(w.row + w.rows, first.y + kTileTexels); ++y)
            for (uint32_t x = first.x; x < std::min(w.column + w.columns, first.x + kTileTexels); ++x) {
                const uint32_t id = group_.triangle[w.index(x, y)];
                if (id != 0 && set_.scene.mesh.chart[id - 1] != kNoChart) work(glm::uvec2(x, y), id - 1);
            }
    }
    // Calls work(first texel) for each tile of a row of tiles.
    template<class Work>
    void overTiles(uint32_t row, const Work& work) const {
        const TexelWindow& w = group_.window;
        for (uint32_t x = w.column; x < w.column + w.columns; x += kTileTexels)
            work(glm::uvec2(x, w.row + row * kTileTexels));
    }

    // Counts the patches of a row of tiles.
    uint32_t countRow(uint32_t row) const {
        uint32_t count = 0;
        overTiles(row, [&](glm::uvec2 tile) {
            overTexels(tile, [&](glm::uvec2 texel, uint32_t triangle) {
                const glm::vec4& emission = group_.emission[group_.window.index(texel.x, texel.y)];
                count += hasBack(triangle, emission) ? 2u : 1u;
            });
            for (const ThinChart& thin : thin_[tileOf(tile.x, tile.y)])
                count += hasBack(thin.triangle, thinPatch(thin).emission) ? 2u : 1u;
        });
        return count;
    }

    // Fills in the patches of a row of tiles, from `next` on: in each tile fronts, thin charts, backs.
    void fillRow(uint32_t row, uint32_t next) {
        std::vector<NewPatch> backs;
        const auto putFront = [&](const NewPatch& p, uint32_t triangle) {
            put(next++, p);
            if (hasBack(triangle, p.emission)) backs.push_back(backOf(p));
        };
        overTiles(row, [&](glm::uvec2 tile) {
            overTexels(tile, [&](glm::uvec2 texel, uint32_t triangle) {
                set_.scene.texelToPatch[group_.window.index(texel.x, texel.y)] = next;
                putFront(texelPatch(texel, triangle), triangle);
            });
            for (const ThinChart& thin : thin_[tileOf(tile.x, tile.y)]) {
                const NewPatch p = thinPatch(thin);
                // Where no other patch has its texel it is shown there: else neighbours would fill it, which
                // are strangers where charts lie side by side.
                const uint32_t texel = shader::patchTexel(p.patch.flags);
                uint32_t& shown =
                    set_.scene.texelToPatch[group_.window.index(texel % group_.size, texel / group_.size)];
                if (shown == kNoPatch) shown = next;
                putFront(p, thin.triangle);
            }
            for (const NewPatch& back : backs)
                put(next++, back);
            backs.clear();
        });
    }

    // Finds the patch in the middle of each chart's, which stands for triangles that have none nearby.
    void findMiddles() {
        const std::vector<uint32_t>& charts = set_.scene.patchChart;
        const size_t chartCount = set_.scene.mesh.chartCount;
        // There are few portions, as each has an array over charts.
        constexpr size_t kLeast = size_t{1} << 18, kMostPortions = 64;
        const size_t portion = std::max(kLeast, (charts.size() + kMostPortions - 1) / kMostPortions);
        const auto portions = static_cast<uint32_t>((charts.size() + portion - 1) / portion);
        // Calls work(patch, chart) for the patches of a portion that have a chart.
        const auto overPortion = [&](uint32_t number, const auto& work) {
            const size_t end = std::min(charts.size(), (number + 1) * portion);
            for (size_t i = number * portion; i < end; ++i)
                if (charts[i] != kNoChart) work(static_cast<uint32_t>(i), charts[i]);
        };
        std::vector<std::vector<uint32_t>> seen(portions); // of each chart: in the portion, then before it
        runWatched(pool_, kPatchesPhase, portions, [&](uint32_t number) {
            seen[number].assign(chartCount, 0);
            overPortion(number, [&](uint32_t, uint32_t chart) { ++seen[number][chart]; });
        });
        std::vector<uint32_t> counts(chartCount, 0);
        for (std::vector<uint32_t>& own : seen)
            for (size_t chart = 0; chart < chartCount; ++chart)
                counts[chart] += std::exchange(own[chart], counts[chart]);
        middles_.assign(chartCount, kNoPatch);
        runWatched(pool_, kPatchesPhase, portions, [&](uint32_t number) {
            overPortion(number, [&](uint32_t patch, uint32_t chart) {
                if (seen[number][chart]++ == counts[chart] / 2) middles_[chart] = patch;
            });
        });
    }

    NewPatch texelPatch(glm::uvec2 texel, uint32_t triangle) const {
        const size_t at = group_.window.index(texel.x, texel.y);
        const TriangleFrame& frame = frames_[triangle];
        NewPatch p;
        p.chart = set_.scene.mesh.chart[triangle];
        const float scale = areaScale_[p.chart];
        p.edges = {frame.du * std::sqrt(scale), frame.dv * std::sqrt(scale)};
        fill(p, glm::vec3(group_.pos[at]), glm::vec3(group_.nrm[at]), frame.normal,
             texelArea_[triangle] * scale, texel.y * group_.size + texel.x);
        p.albedo = group_.mat[at];
        p.emission = group_.emission[at];
        p.material = set_.scene.mesh.material[triangle];
        p.instance = set_.scene.mesh.instance[triangle];
        // Holes send nothing. The offset stays that of the whole texel.
        const float solid = group_.solidAt(at);
        p.patch.area *= solid;
        p.edges.du *= std::sqrt(solid);
        p.edges.dv *= std::sqrt(solid);
        return p;
    }

    // Makes the one patch of a chart that covers no texel centre: in the middle of its largest triangle, or
    // in the solid place nearest to it, with all of the chart's solid area and the colour that is there.
    NewPatch thinPatch(const ThinChart& thin) const {
        const WorldMesh& m = set_.scene.mesh;
        const glm::vec3* p = &m.positions[size_t{thin.triangle} * 3];
        const glm::vec3* n = &m.normals[size_t{thin.triangle} * 3];
        glm::vec3 position = (p[0] + p[1] + p[2]) / 3.0f, shading = n[0] + n[1] + n[2];
        SurfaceColour colour;
        if (isMasked(thin.triangle)) {
            const SolidPart part = solidPart(reader_, m, thin.triangle, group_.size);
            position = p[0] + ((p[1] - p[0]) * part.place.y + (p[2] - p[0]) * part.place.z);
            shading = n[0] * part.place.x + n[1] * part.place.y + n[2] * part.place.z;
            colour = part.colour;
        } else {
            colour = reader_.colourAt(thin.triangle, glm::vec3(1.0f / 3.0f));
        }
        const glm::vec3 normal = frames_[thin.triangle].normal;
        const glm::vec3 side = glm::normalize(p[1] - p[0]) * std::sqrt(thin.area);
        const glm::uvec2 texel = texelOf(centroidUv(thin.triangle));
        NewPatch result;
        result.chart = m.chart[thin.triangle];
        result.edges = {side, glm::cross(normal, side)};
        fill(result, position, shading, normal, thin.area, texel.y * group_.size + texel.x);
        result.patch.flags |= shader::kPatchThin;
        result.material = m.material[thin.triangle];
        result.instance = m.instance[thin.triangle];
        result.albedo = colour.albedo;
        result.emission = colour.emission;
        return result;
    }

    void fill(NewPatch& p, glm::vec3 position, glm::vec3 shading, glm::vec3 normal, float area,
              uint32_t texel) const {
        // Shading normals may be missing or point behind the surface; then the geometric one serves.
        const float length = glm::length(shading);
        shading = length > 0.0f ? shading / length : normal;
        if (!rtrad_ && glm::dot(shading, normal) <= 0.0f) shading = normal;
        const float reach = std::max({std::abs(position.x), std::abs(position.y), std::abs(position.z)});
        p.patch.position = position;
        p.patch.normal = rtrad_ ? shading : normal;
        p.patch.shading = shading;
        p.patch.area = area;
        p.patch.offset = rtrad_ ? 0.0f : kOffset * std::sqrt(area) + kFloatError * reach;
        p.patch.flags = shader::kPatchSends | texel << shader::kTexelShift;
    }

    // Tells whether there is a patch on the back, too, where the texel has this emission for a factor of 1.
    bool hasBack(uint32_t triangle, const glm::vec4& pattern) const {
        const Material& material = materials_[set_.scene.mesh.material[triangle]];
        const glm::vec3 emission = material.emission * glm::vec3(pattern);
        const bool emits = emission.r > 0.0f || emission.g > 0.0f || emission.b > 0.0f;
        return !rtrad_ && material.doubleSided && emits;
    }

    static NewPatch backOf(const NewPatch& front) {
        NewPatch back = front;
        back.patch.normal = back.patch.shading = -front.patch.normal;
        back.patch.flags |= shader::kPatchBackSide;
        back.albedo = glm::vec4(0.0f);
        back.chart = kNoChart;
        return back;
    }

    void addHitTriangles() {
        const WorldMesh& m = set_.scene.mesh;
        set_.scene.hitTriangles.resize(m.triangleCount());
        inPortions(m.triangleCount(), kTrianglesEach, [&](uint32_t t) {
            const glm::vec2* uv = &m.lightmapUv[size_t{t} * 3];
            set_.scene.hitTriangles[t] = {uv[0],
                                          uv[1],
                                          uv[2],
                                          m.chart[t],
                                          representative(t),
                                          frames_[t].normal,
                                          materials_[m.material[t]].doubleSided};
        });
    }

    // Returns the patch of the triangle's chart nearest to the triangle's centre, among those within a few
    // texels, else any of the chart.
    uint32_t representative(uint32_t triangle) const {
        constexpr int kReach = 4; // texels
        const uint32_t chart = set_.scene.mesh.chart[triangle];
        if (chart == kNoChart || middles_[chart] == kNoPatch) return kNoPatch;
        const glm::vec2 uv = centroidUv(triangle);
        const glm::vec2 centre = uv * static_cast<float>(group_.size);
        const auto texel = glm::ivec2(texelOf(uv));
        const glm::ivec2 first(group_.window.column, group_.window.row);
        const glm::ivec2 last = first + glm::ivec2(group_.window.columns, group_.window.rows) - 1;
        const glm::ivec2 from = glm::max(first, texel - kReach), to = glm::min(last, texel + kReach);
        uint32_t best = kNoPatch;
        float bestDistance = std::numeric_limits<float>::max();
        for (int y = from.y; y <= to.y; ++y) {
            for (int x = from.x; x <= to.x; ++x) {
                const uint32_t p = set_.scene.texelToPatch[group_.window.index(static_cast<uint32_t>(x),
                                                                               static_cast<uint32_t>(y))];
                if (p == kNoPatch || set_.scene.patchChart[p] != chart) continue;
                const glm::vec2 d = glm::vec2(static_cast<float>(x), static_cast<float>(y)) + 0.5f - centre;
                if (glm::dot(d, d) < bestDistance) {
                    bestDistance = glm::dot(d, d);
                    best = p;
                }
            }
        }
        return best != kNoPatch ? best : middles_[chart];
    }

    const Scene& scene_;
    std::vector<Material> materials_;
    const TextureGroup& group_;
    const bool rtrad_, part_;
    WorkerPool* const pool_;
    PatchSet set_;
    const SurfaceReader reader_;               // of the mesh in the set
    std::vector<TriangleFrame> frames_;        // per triangle
    std::vector<float> texelArea_;             // per triangle: of one of its texels [m^2]
    std::vector<float> areaScale_;             // per chart
    std::vector<std::vector<ThinChart>> thin_; // per tile
    std::vector<uint32_t> middles_;            // per chart: the patch in the middle of its own
};

} // namespace

PatchSet buildPatches(const Scene& scene, WorldMesh mesh, const TextureGroup& group, const PatchDesc& desc) {
    PatchBuilder builder(scene, std::move(mesh), group, desc);
    return builder.build(nullptr);
}

PatchSet buildPatches(const Scene& scene, WorldMesh mesh, const TextureGroup& group, const PatchDesc& desc,
                      const KnownCovers& known) {
    PatchBuilder builder(scene, std::move(mesh), group, desc);
    return builder.build(&known);
}

shader::ChunkBounds chunkBounds(const PatchSet& patches, uint32_t chunk) {
    shader::ChunkBounds b{glm::vec3(std::numeric_limits<float>::max()),
                          glm::vec3(std::numeric_limits<float>::lowest()), 0.0f};
    for (uint32_t i = chunk * kChunk; i < std::min((chunk + 1) * kChunk, patches.count); ++i) {
        const shader::Patch& p = patches.scene.patches[i];
        if (p.flags == 0 && p.area == 0.0f) continue;
        b.lo = glm::min(b.lo, p.position);
        b.hi = glm::max(b.hi, p.position);
        b.size = std::max(b.size, std::sqrt(p.area));
    }
    return b;
}

} // namespace relume
