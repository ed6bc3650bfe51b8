#include "assets/atlas/lightmap_atlas.h"

#include "assets/atlas/chart_quality.h"
#include "assets/atlas/page_deal.h"
#include "assets/atlas/rect_pack.h"
#include "assets/atlas/uv_grid.h"
#include "assets/base/error.h"
#include "assets/base/warnings.h"
#include "assets/base/watch.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

namespace relume {

namespace {

constexpr double kMaxOverlap = 0.01;   // of the UV area
constexpr double kUvTolerance = 1e-4;  // exporters' rounding; below half a texel of a 4096 atlas
constexpr double kMinUvExtent = 1e-6;  // below it a set is a point, as of a mesh never unwrapped
constexpr uint32_t kMeshGutter = 2;    // [texels]
constexpr uint32_t kAtlasCells = 2048; // to a side of the grid that measures whole atlases

/// Tells what one UV set of one mesh is worth as a lightmap atlas.
struct SetQuality {
    bool usable = false;
    bool complete = false; // every primitive has the set
    std::string fault;     // why it is not usable
    glm::dvec2 low{0.0}, high{0.0};
    double uvArea = 0.0;
    uint64_t visits = 0; // of cells, to find overlaps
};

/// Holds the set chosen for a mesh; texCoord -1: none.
struct MeshChoice {
    int texCoord = -1;
    SetQuality quality;
};

bool hasUvTriangles(const Primitive& primitive, int set) {
    return !primitive.indices.empty() && uvSet(primitive, set).size() == primitive.positions.size();
}

template<typename Visit>
void forEachUvTriangle(const Mesh& mesh, int set, const Visit& visit) {
    for (const Primitive& primitive : mesh.primitives) {
        if (!hasUvTriangles(primitive, set)) continue;
        const std::vector<glm::vec2>& uvs = uvSet(primitive, set);
        for (size_t i = 0; i < primitive.indices.size(); i += 3) {
            const uint32_t* t = &primitive.indices[i];
            visit(glm::dvec2(uvs[t[0]]), glm::dvec2(uvs[t[1]]), glm::dvec2(uvs[t[2]]));
        }
    }
}

/// Adds a mesh's triangles as long as the grid can still say that they do not overlap: each may cover all
/// cells, so that many triangles, or meshes, of the same UVs would cost their product.
void addWhileFree(UvGrid& grid, const Mesh& mesh, int set) {
    forEachUvTriangle(mesh, set, [&](const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
        if (!grid.mustOverlap(kMaxOverlap)) grid.add(a, b, c);
    });
}

double cross(const glm::dvec2& a, const glm::dvec2& b) {
    return a.x * b.y - a.y * b.x;
}

SetQuality assess(const Mesh& mesh, int set) {
    SetQuality quality;
    const auto has = [set](const Primitive& p) { return hasUvTriangles(p, set); };
    if (std::none_of(mesh.primitives.begin(), mesh.primitives.end(), has)) {
        quality.fault = fmt::format("has no TEXCOORD_{}", set);
        return quality;
    }
    quality.complete = std::all_of(mesh.primitives.begin(), mesh.primitives.end(),
                                   [&](const Primitive& p) { return p.indices.empty() || has(p); });
    quality.low = glm::dvec2(std::numeric_limits<double>::max());
    quality.high = -quality.low;
    size_t triangles = 0;
    forEachUvTriangle(mesh, set, [&](const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
        quality.low = glm::min(quality.low, glm::min(a, glm::min(b, c)));
        quality.high = glm::max(quality.high, glm::max(a, glm::max(b, c)));
        quality.uvArea += 0.5 * std::abs(cross(b - a, c - a));
        ++triangles;
    });
    const glm::dvec2 extent = quality.high - quality.low;
    if (!(std::min(quality.low.x, quality.low.y) >= -kUvTolerance) ||
        !(std::max(quality.high.x, quality.high.y) <= 1.0 + kUvTolerance)) {
        quality.fault = fmt::format("has a TEXCOORD_{} outside [0,1]", set);
        return quality;
    }
    if (std::min(extent.x, extent.y) < kMinUvExtent) {
        quality.fault = fmt::format("has a TEXCOORD_{} without area", set);
        return quality;
    }
    // Where charts lie far apart, a coarse grid sees few of their texels: a finer one has the last word.
    bool overlaps = true;
    for (uint32_t cells = UvGrid::sizeFor(triangles); overlaps; cells = kAtlasCells) {
        UvGrid grid(cells, quality.low, quality.high);
        addWhileFree(grid, mesh, set);
        quality.visits += grid.visits();
        overlaps = grid.overlaps(kMaxOverlap);
        if (cells == kAtlasCells) break;
    }
    if (overlaps) {
        quality.fault = fmt::format("has a TEXCOORD_{} overlapping itself by more than 1 %", set);
        return quality;
    }
    quality.usable = true;
    return quality;
}

std::string nameOf(const std::vector<Mesh>& meshes, size_t index) {
    const std::string& name = meshes[index].name;
    return name.empty() ? fmt::format("mesh {}", index) : "mesh " + inQuotes(name);
}

MeshChoice chooseSet(const Scene& scene, size_t meshIndex, Warnings& warnings, uint64_t& visits) {
    const Mesh& mesh = scene.meshes[meshIndex];
    const std::string name = nameOf(scene.meshes, meshIndex);
    SetQuality second = assess(mesh, 1);
    visits += second.visits;
    if (second.usable && second.complete) return {1, second};
    SetQuality first = assess(mesh, 0);
    visits += first.visits;
    const bool takeFirst = first.usable && (first.complete || !second.usable);
    if (takeFirst && !second.fault.empty() && second.fault != "has no TEXCOORD_1")
        warnings.add(name, second.fault + ": TEXCOORD_0 is taken instead");
    MeshChoice choice = takeFirst       ? MeshChoice{0, first}
                        : second.usable ? MeshChoice{1, second}
                                        : MeshChoice{-1, second};
    if (choice.texCoord < 0)
        choice.quality.fault = second.fault == "has no TEXCOORD_1" && first.fault != "has no TEXCOORD_0"
                                   ? second.fault + " and " + first.fault
                                   : second.fault;
    if (choice.texCoord >= 0 && !choice.quality.complete)
        warnings.add(
            name, fmt::format("has parts without TEXCOORD_{}, which block light only: run 'relume unwrap' or "
                              "leave out --no-unwrap",
                              choice.texCoord));
    return choice;
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
bool formOneAtlas(const Scene& scene, LightmapAtlas& atlas) {
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
        for (size_t i = 0; i < scene.instances.size(); ++i)
            if (atlas.instances[i].texCoord >= 0 && atlas.instances[i].page == page)
                addWhileFree(grid, scene.meshes[static_cast<size_t>(scene.instances[i].mesh)],
                             atlas.instances[i].texCoord);
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

std::vector<MeshChoice> chooseSets(const Scene& scene, bool unwrapped, LightmapAtlas& atlas,
                                   Warnings& warnings) {
    const char* mend =
        unwrapped ? "give its triangles an area" : "run 'relume unwrap' or leave out --no-unwrap";
    std::vector<MeshChoice> choices(scene.meshes.size());
    std::vector<bool> chosen(scene.meshes.size());
    size_t usable = 0;
    std::string fault;
    WatchedLoop loop("atlas", static_cast<double>(scene.instances.size()));
    for (size_t i = 0; i < scene.instances.size(); ++i, loop.step()) {
        const size_t mesh = static_cast<size_t>(scene.instances[i].mesh);
        if (scene.meshes[mesh].primitives.empty()) continue;
        if (!chosen[mesh]) {
            chosen[mesh] = true;
            choices[mesh] = chooseSet(scene, mesh, warnings, atlas.visits);
            const std::string& problem = choices[mesh].quality.fault;
            if (choices[mesh].texCoord < 0)
                warnings.add(nameOf(scene.meshes, mesh), problem + ", it blocks light only: " + mend);
            if (choices[mesh].texCoord < 0 && fault.empty())
                fault = nameOf(scene.meshes, mesh) + " " + problem;
        }
        atlas.instances[i].texCoord = choices[mesh].texCoord;
        usable += choices[mesh].texCoord >= 0;
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
    const std::vector<MeshChoice> choices = chooseSets(scene, unwrapped, atlas, warnings);
    const bool asItIs = atlas.pages.count == scene.pages && formOneAtlas(scene, atlas);
    atlas.warnings = warnings.lines(scene.path);
    if (!asItIs)
        repack(scene, choices, size, atlas, memory);
    else if (memory)
        *memory = {};
    return atlas;
}

namespace {

bool hasSurface(const Mesh& mesh) {
    for (const Primitive& primitive : mesh.primitives)
        for (size_t i = 0; i + 2 < primitive.indices.size(); i += 3) {
            const auto corner = [&](size_t k) { return primitive.positions[primitive.indices[i + k]]; };
            const glm::vec3 a = corner(0);
            if (glm::cross(corner(1) - a, corner(2) - a) != glm::vec3(0.0f)) return true;
        }
    return false;
}

} // namespace

size_t countUnmapped(const Scene& scene) {
    std::vector<bool> used(scene.meshes.size(), false);
    for (const Instance& instance : scene.instances)
        used[static_cast<size_t>(instance.mesh)] = true;
    size_t count = 0;
    for (size_t i = 0; i < used.size(); ++i)
        count += used[i] && hasSurface(scene.meshes[i]) && lightmapSet(scene.meshes[i]) < 0 ? 1 : 0;
    return count;
}

int lightmapSet(const Mesh& mesh) {
    for (int set : {1, 0}) {
        const SetQuality quality = assess(mesh, set);
        if (quality.usable && quality.complete) return set;
    }
    return -1;
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
