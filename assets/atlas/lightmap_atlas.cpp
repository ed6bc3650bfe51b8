#include "assets/atlas/lightmap_atlas.h"

#include "assets/atlas/chart_quality.h"
#include "assets/atlas/page_deal.h"
#include "assets/atlas/rect_pack.h"
#include "assets/atlas/uv_grid.h"
#include "assets/atlas/uv_sets.h"
#include "assets/base/error.h"
#include "assets/base/warnings.h"
#include "assets/base/watch.h"
#include "assets/base/worker_pool.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <span>
#include <utility>

namespace relume {

namespace {

constexpr uint32_t kMeshGutter = 2; // [texels]

double cross(const glm::dvec2& a, const glm::dvec2& b) {
    return a.x * b.y - a.y * b.x;
}

std::string nameOf(const std::vector<Mesh>& meshes, size_t index) {
    const std::string& name = meshes[index].name;
    return name.empty() ? fmt::format("mesh {}", index) : "mesh " + inQuotes(name);
}

double worldArea(const Instance& instance, const Mesh& mesh, int set) {
    const glm::dmat3 linear(instance.transform);
    double area = 0.0;
    for (const Primitive& primitive : mesh.primitives) {
        if (!hasUvTriangles(primitive, set)) continue;
        for (size_t i = 0; i < primitive.indices.size(); i += 3) {
            const uint32_t* t = &primitive.indices[i];
            const glm::dvec3 a(primitive.positions[t[0]]);
            area += 0.5 * glm::length(glm::cross(linear * (glm::dvec3(primitive.positions[t[1]]) - a),
                                                 linear * (glm::dvec3(primitive.positions[t[2]]) - a)));
        }
    }
    return std::isfinite(area) ? area : 0.0;
}

/// Tells whether all instances' UVs, as they are, make one atlas, page by page.
bool formOneAtlas(const Scene& scene, LightmapAtlas& atlas, WorkerPool& pool) {
    std::set<std::pair<size_t, uint32_t>> seen;
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        const AtlasRect& rect = atlas.instances[i];
        if (rect.texCoord < 0) continue;
        if (rect.page >= atlas.pages.count) return false;
        const size_t mesh = static_cast<size_t>(scene.instances[i].mesh);
        // Two instances of a mesh cover the same texels.
        if (!seen.emplace(mesh, rect.page).second) return false;
    }
    for (uint32_t page = 0; page < atlas.pages.count; ++page) {
        UvGrid grid(kAtlasCells, glm::dvec2(0.0), glm::dvec2(1.0));
        std::vector<UvRun> runs;
        for (size_t i = 0; i < scene.instances.size(); ++i)
            if (atlas.instances[i].texCoord >= 0 && atlas.instances[i].page == page)
                addRuns(scene.meshes[static_cast<size_t>(scene.instances[i].mesh)],
                        atlas.instances[i].texCoord, runs);
        addWhileFree(grid, runs, pool);
        atlas.visits += grid.visits();
        if (grid.overlaps(kMaxOverlap)) return false;
    }
    return true;
}

/// Holds an instance's UV bounds and how many metres one unit of UV is.
struct Footprint {
    size_t instance;
    glm::dvec2 low, extent; // [UV]
    double metres;          // per unit of UV
};

uint32_t texels(double metres, double density, uint32_t size) {
    return static_cast<uint32_t>(
        std::clamp(std::round(metres * density), 1.0, size + 1.0)); // size + 1: never fits
}

bool packAt(const std::vector<Footprint>& footprints, double density, uint32_t size,
            std::vector<PackedRect>& rects) {
    for (size_t i = 0; i < rects.size(); ++i) {
        const glm::dvec2 metres = footprints[i].extent * footprints[i].metres;
        rects[i].width = texels(metres.x, density, size);
        rects[i].height = texels(metres.y, density, size);
    }
    return packRects(rects, size, size, kMeshGutter);
}

/// Packs the rectangles, each into its page of edge `size`, at a density; tells whether all fit.
bool packPagesAt(const std::vector<std::vector<Footprint>>& pages, double density, uint32_t size,
                 std::vector<std::vector<PackedRect>>& rects) {
    rects.resize(pages.size());
    for (size_t page = 0; page < pages.size(); ++page) {
        rects[page].resize(pages[page].size());
        if (!packAt(pages[page], density, size, rects[page])) return false;
    }
    return true;
}

double areaOf(const Footprint& f) {
    return f.extent.x * f.extent.y * f.metres * f.metres;
}

struct DensestPacking {
    std::vector<std::vector<PackedRect>> rects; // of each page
    double density = 0.0;                       // [texels/m]
};

/// Packs the rectangles at the highest common density at which all fit, found by bisection.
DensestPacking packDensest(const Scene& scene, const std::vector<std::vector<Footprint>>& pages,
                           uint32_t size) {
    DensestPacking best;
    std::vector<std::vector<PackedRect>> rects;
    double area = 0.0; // of the fullest page
    size_t count = 0;
    for (const std::vector<Footprint>& footprints : pages) {
        double own = 0.0;
        for (const Footprint& f : footprints)
            own += areaOf(f);
        area = std::max(area, own);
        count += footprints.size();
    }
    double low = 0.0, high = area > 0.0 ? size / std::sqrt(area) : 1.0;
    if (packPagesAt(pages, high, size, rects)) return {rects, high};
    constexpr int kSteps = 14; // leaves 1/16384 of the bound
    for (int step = 0; step < kSteps; ++step) {
        tellWatch("atlas", double(step) / kSteps);
        const double middle = 0.5 * (low + high);
        const bool fits = packPagesAt(pages, middle, size, rects);
        (fits ? low : high) = middle;
        if (fits) best = {rects, middle};
    }
    if (best.rects.empty() && packPagesAt(pages, 0.0, size, rects)) best = {rects, 0.0};
    if (best.rects.empty())
        throw Error(fmt::format(
            "{}: {} instances do not fit {} of {} x {} texels: use a larger --size", scene.path, count,
            pages.size() == 1 ? "a lightmap" : fmt::format("{} pages", pages.size()), size, size));
    return best;
}

/// Gives an instance its rectangle. The bounds lie on whole texels: charts aligned to texels inside the
/// mesh's own rectangle stay so.
void place(LightmapAtlas& atlas, const Footprint& footprint, const PackedRect& packed, uint32_t page,
           uint32_t size) {
    const double border = borderOf(atlas.pages);
    AtlasRect& rect = atlas.instances[footprint.instance];
    const glm::dvec2 extent(packed.width, packed.height), corner(packed.x + border, packed.y + border);
    const glm::dvec2 scale = extent / footprint.extent / double(size);
    rect.scale = glm::vec2(scale);
    rect.offset = glm::vec2(corner / double(size) - footprint.low * scale);
    rect.page = page;
}

std::vector<Footprint> footprintsOf(const Scene& scene, const std::vector<MeshChoice>& choices,
                                    const LightmapAtlas& atlas) {
    std::vector<Footprint> all;
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        if (atlas.instances[i].texCoord < 0) continue;
        const size_t mesh = static_cast<size_t>(scene.instances[i].mesh);
        const SetQuality& quality = choices[mesh].quality;
        const double area = worldArea(scene.instances[i], scene.meshes[mesh], choices[mesh].texCoord);
        const double metres = quality.uvArea > 0.0 ? std::sqrt(area / quality.uvArea) : 0.0;
        all.push_back({i, quality.low, quality.high - quality.low, metres});
    }
    return all;
}

/// Lays the rectangles where the memory has them; tells whether that goes.
bool repackAsBefore(const Scene& scene, const std::vector<Footprint>& all, uint32_t size,
                    LightmapAtlas& atlas, RectMemory& memory) {
    if (memory.size != size || memory.pages != atlas.pages.count || !(memory.density > 0.0)) return false;
    std::vector<WantedRect> wanted;
    for (const Footprint& f : all) {
        const glm::dvec2 metres = f.extent * f.metres;
        wanted.push_back({scene.instances[f.instance].name, texels(metres.x, memory.density, size),
                          texels(metres.y, memory.density, size)});
    }
    std::optional<RememberedRects> again =
        placeAgain(memory, wanted, size - 2 * borderOf(atlas.pages), kMeshGutter);
    if (!again) return false;
    for (size_t i = 0; i < all.size(); ++i)
        place(atlas, all[i], again->objects[i].rect, again->objects[i].page, size);
    if (again->coarser > 0)
        atlas.warnings.push_back(fmt::format("{}: {} of {} objects have {:.2g} of the texels per metre of "
                                             "others, or more, so that the others stay "
                                             "where they are: open the file again to make all alike",
                                             scene.path, again->coarser, all.size(), again->leastShare));
    memory.objects = std::move(again->objects);
    return true;
}

void repack(const Scene& scene, const std::vector<MeshChoice>& choices, uint32_t size, LightmapAtlas& atlas,
            RectMemory* memory) {
    const std::vector<Footprint> all = footprintsOf(scene, choices, atlas);
    atlas.repacked = true;
    const uint32_t border = borderOf(atlas.pages);
    if (size <= 2 * border)
        throw Error(fmt::format("{}: pages of {} x {} texels are all border: use a larger --size", scene.path,
                                size, size));
    if (memory && repackAsBefore(scene, all, size, atlas, *memory)) return;
    std::vector<double> areas;
    for (const Footprint& footprint : all)
        areas.push_back(areaOf(footprint));
    const std::vector<uint32_t> dealt = dealToPages(areas, atlas.pages.count);
    std::vector<std::vector<Footprint>> pages(atlas.pages.count);
    for (size_t i = 0; i < all.size(); ++i)
        pages[dealt[i]].push_back(all[i]);
    const DensestPacking packed = packDensest(scene, pages, size - 2 * border);
    if (memory)
        *memory = {.size = size, .pages = atlas.pages.count, .density = packed.density, .objects = {}};
    std::vector<size_t> next(pages.size(), 0);
    for (size_t i = 0; i < all.size(); ++i) {
        const PackedRect& rect = packed.rects[dealt[i]][next[dealt[i]]++];
        place(atlas, all[i], rect, dealt[i], size);
        if (memory) memory->objects.push_back({scene.instances[all[i].instance].name, dealt[i], rect});
    }
}

/// Gives each instance the set of its mesh, and says what is wrong with it.
std::vector<MeshChoice> takeSets(const Scene& scene, bool unwrapped, LightmapAtlas& atlas, Warnings& warnings,
                                 WorkerPool& pool) {
    const char* mend =
        unwrapped ? "give its triangles an area" : "run 'relume unwrap' or leave out --no-unwrap";
    std::vector<MeshChoice> choices = chooseSets(scene, pool);
    const std::vector<bool> used = usedMeshes(scene);
    std::vector<bool> told(used.size());
    size_t usable = 0;
    std::string fault;
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        const size_t mesh = static_cast<size_t>(scene.instances[i].mesh);
        if (!used[mesh]) continue;
        const MeshChoice& choice = choices[mesh];
        if (!told[mesh]) {
            told[mesh] = true;
            atlas.visits += choice.visits;
            const std::string name = nameOf(scene.meshes, mesh), &problem = choice.quality.fault;
            for (const std::string& warning : choice.warnings)
                warnings.add(name, warning);
            if (choice.texCoord < 0) warnings.add(name, problem + ", it blocks light only: " + mend);
            if (choice.texCoord < 0 && fault.empty()) fault = name + " " + problem;
        }
        atlas.instances[i].texCoord = choice.texCoord;
        usable += choice.texCoord >= 0;
    }
    if (usable == 0)
        throw Error(fmt::format("{}: no mesh has usable lightmap UVs ({}): {}", scene.path,
                                fault.empty() ? "there is none" : fault, mend));
    return choices;
}

} // namespace

LightmapAtlas buildAtlas(const Scene& scene, uint32_t size, bool unwrapped,
                         std::optional<LightmapPages> pages, RectMemory* memory) {
    ASSERT(size > 0);
    LightmapAtlas atlas;
    atlas.pages = pages.value_or(LightmapPages{scene.pages});
    ASSERT(atlas.pages.count >= 1 && atlas.pages.count <= kMostPages);
    atlas.instances.resize(scene.instances.size());
    for (size_t i = 0; i < scene.instances.size(); ++i)
        atlas.instances[i].page = scene.instances[i].page;
    Warnings warnings;
    WorkerPool pool(threadsFor(scene.meshes));
    const std::vector<MeshChoice> choices = takeSets(scene, unwrapped, atlas, warnings, pool);
    const bool asItIs = atlas.pages.count == scene.pages && formOneAtlas(scene, atlas, pool);
    atlas.warnings = warnings.lines(scene.path);
    if (!asItIs)
        repack(scene, choices, size, atlas, memory);
    else if (memory)
        *memory = {};
    return atlas;
}

AtlasStatistics measureAtlas(const Scene& scene, const LightmapAtlas& atlas, uint32_t size) {
    AtlasStatistics statistics;
    Stretch stretch;
    constexpr uint32_t kMostColumns =
        4; // of pages that have as many cells each: the grid has a byte for each
    UvGrid grid(kAtlasCells * std::min(atlas.pages.columns(), kMostColumns), glm::dvec2(0.0),
                glm::dvec2(1.0));
    double uvSum = 0.0, worldSum = 0.0, densityMin = std::numeric_limits<double>::max();
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        const AtlasRect& rect = atlas.instances[i];
        if (rect.texCoord < 0) continue;
        const glm::dmat3 linear(scene.instances[i].transform);
        for (const Primitive& primitive :
             scene.meshes[static_cast<size_t>(scene.instances[i].mesh)].primitives) {
            if (!hasUvTriangles(primitive, rect.texCoord)) continue;
            const std::vector<glm::vec2>& uvs = uvSet(primitive, rect.texCoord);
            for (size_t t = 0; t < primitive.indices.size(); t += 3) {
                std::array<glm::dvec2, 3> uv, onSheet;
                std::array<glm::dvec3, 3> p;
                for (size_t k = 0; k < 3; ++k) {
                    const uint32_t v = primitive.indices[t + k];
                    uv[k] = glm::dvec2(uvs[v] * rect.scale + rect.offset);
                    onSheet[k] = atlas.pages.count == 1 ? uv[k] : glm::dvec2(atlas.sheetUv(i, uvs[v]));
                    p[k] = linear * glm::dvec3(primitive.positions[v]);
                }
                grid.add(onSheet[0], onSheet[1], onSheet[2]);
                const double uvArea = 0.5 * std::abs(cross(uv[1] - uv[0], uv[2] - uv[0]));
                const double world = 0.5 * glm::length(glm::cross(p[1] - p[0], p[2] - p[0]));
                uvSum += uvArea;
                worldSum += world;
                if (!(uvArea > 0.0) || !(world > 0.0)) continue;
                const double density = size * std::sqrt(uvArea / world);
                densityMin = std::min(densityMin, density);
                // Mirrored instances have mirrored UVs, which are no stretch.
                if (cross(uv[1] - uv[0], uv[2] - uv[0]) < 0.0)
                    for (glm::dvec2& corner : uv)
                        corner.x = -corner.x;
                stretch.add(p.data(), uv.data());
                statistics.texelDensityMax = std::max(statistics.texelDensityMax, density);
            }
        }
    }
    // The places of the sheet that are no page's do not count.
    const double cells = static_cast<double>(grid.cells()) * atlas.pages.count /
                         (atlas.pages.columns() * atlas.pages.columns());
    statistics.coverage = static_cast<double>(grid.covered()) / cells;
    if (grid.covered() > 0)
        statistics.overlap = static_cast<double>(grid.overlapped()) / static_cast<double>(grid.covered());
    if (worldSum > 0.0) statistics.texelDensityMean = size * std::sqrt(uvSum / worldSum);
    if (stretch.surface > 0.0) statistics.stretch = stretch.normalised();
    statistics.texelDensityMin = std::min(densityMin, statistics.texelDensityMax);
    return statistics;
}

} // namespace relume
