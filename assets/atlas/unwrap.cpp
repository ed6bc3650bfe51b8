#include "assets/atlas/unwrap.h"

#include "assets/atlas/lightmap_atlas.h"
#include "assets/atlas/charts.h"
#include "assets/atlas/rect_pack.h"
#include "assets/base/error.h"
#include "assets/base/numbering.h"
#include "assets/base/warnings.h"
#include "assets/base/watch.h"
#include "assets/base/worker_pool.h"

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>

namespace relume {

namespace {

constexpr uint32_t kChartGutter = 2; // [texels], between charts
constexpr double kFill = 0.5; // share of an atlas that charts of usual shapes cover: where the search starts
constexpr double kRectFill = 0.85;     // share of an atlas that the meshes' rectangles fill when packed
constexpr int kSearchSteps = 8;        // of the density; one packing each
constexpr size_t kManyCharts = 20000;  // above it a packing takes long and the search is cut short
constexpr double kMaxTexels = 65536.0; // [texels] to a side of one mesh

/// Holds the UVs of a mesh's triangle corners, and which chart each triangle belongs to.
struct Layout {
    std::vector<glm::vec2> uv;   // 3 per triangle
    std::vector<uint32_t> chart; // per triangle, kNoNumber: no area
};

/// Holds a mesh to unwrap.
struct Job {
    size_t mesh;
    std::vector<glm::dvec3> corners; // 3 per triangle [m], as the largest instance stands in the world
    std::vector<PlanarChart> charts;
    double instances = 0.0; // world area of all instances over that of the largest one
};

/// Holds charts in their places.
struct Packing {
    std::vector<PackedRect> rects;
    uint32_t side = 1; // of the square that holds them all [texels]
};

double areaScale(const glm::dmat3& linear) {
    return std::pow(std::abs(glm::determinant(linear)), 2.0 / 3.0);
}

/// Returns the linear part of the largest instance of each mesh; its charts are measured as that one stands
/// in the world.
std::vector<glm::dmat3> largestTransforms(const Scene& scene) {
    std::vector<glm::dmat3> transforms(scene.meshes.size(), glm::dmat3(0.0));
    for (const Instance& instance : scene.instances) {
        glm::dmat3& best = transforms[static_cast<size_t>(instance.mesh)];
        const glm::dmat3 linear(instance.transform);
        if (areaScale(linear) > areaScale(best)) best = linear;
    }
    for (glm::dmat3& transform : transforms)
        if (!(areaScale(transform) > 0.0) || !std::isfinite(areaScale(transform)))
            transform = glm::dmat3(1.0);
    return transforms;
}

std::vector<glm::dvec3> cornersOf(const Mesh& mesh, const glm::dmat3& transform) {
    std::vector<glm::dvec3> corners;
    for (const Primitive& primitive : mesh.primitives)
        for (uint32_t index : primitive.indices)
            corners.push_back(transform * glm::dvec3(primitive.positions[index]));
    return corners;
}

double areaOf(const std::vector<glm::dvec3>& corners) {
    double area = 0.0;
    for (size_t i = 0; i + 2 < corners.size(); i += 3)
        area += 0.5 * glm::length(glm::cross(corners[i + 1] - corners[i], corners[i + 2] - corners[i]));
    return area;
}

glm::dvec2 texelsOf(const PlanarChart& chart, double density) {
    return glm::max(glm::round(chart.extent * density), glm::dvec2(1.0));
}

/// Returns the area of all charts with their gutters [texels], or nothing where a mesh would need more texels
/// than one can have.
std::optional<double> chartArea(const std::vector<PlanarChart>& charts, double density) {
    double area = 0.0;
    for (const PlanarChart& chart : charts) {
        const glm::dvec2 texels = texelsOf(chart, density);
        area += (texels.x + kChartGutter) * (texels.y + kChartGutter);
        if (!(std::max(texels.x, texels.y) <= kMaxTexels) || !(std::sqrt(area) <= kMaxTexels))
            return std::nullopt;
    }
    return area;
}

/// Gives each chart whole texels and packs them, where there is an area for them.
Packing packCharts(const std::vector<PlanarChart>& charts, double density) {
    tellWatch("packing charts");
    const std::optional<double> area = chartArea(charts, density);
    ASSERT(area);
    Packing packing;
    packing.rects.resize(charts.size());
    uint32_t width = 1;
    for (size_t i = 0; i < charts.size(); ++i) {
        const glm::dvec2 texels = texelsOf(charts[i], density);
        packing.rects[i].width = static_cast<uint32_t>(texels.x);
        packing.rects[i].height = static_cast<uint32_t>(texels.y);
        width = std::max(width, packing.rects[i].width);
    }
    width = std::max(width, static_cast<uint32_t>(std::ceil(std::sqrt(*area))));
    constexpr uint32_t kAnyHeight = 1u << 30;
    ASSERT(packRects(packing.rects, width, kAnyHeight, kChartGutter));
    for (const PackedRect& rect : packing.rects)
        packing.side = std::max({packing.side, rect.x + rect.width, rect.y + rect.height});
    return packing;
}

/// Returns the UVs of the packed charts; `side` texels are one unit.
Layout layOut(const Job& job, const Packing& packing, uint32_t side) {
    Layout layout;
    layout.uv.resize(job.corners.size());
    layout.chart.assign(job.corners.size() / 3, kNoNumber);
    for (size_t i = 0; i < job.charts.size(); ++i) {
        // The chart is stretched to fill its texels, so that straight borders run along texel edges.
        const PlanarChart& chart = job.charts[i];
        const PackedRect& rect = packing.rects[i];
        const glm::dvec2 corner(rect.x, rect.y), texels(rect.width, rect.height);
        const glm::dvec2 stretch = texels / glm::max(chart.extent, glm::dvec2(1e-300));
        for (size_t t = 0; t < chart.triangles.size(); ++t) {
            layout.chart[chart.triangles[t]] = static_cast<uint32_t>(i);
            for (size_t k = 0; k < 3; ++k) {
                const glm::dvec2 uv =
                    (corner + glm::min(chart.uv[3 * t + k] * stretch, texels)) / double(side);
                layout.uv[3 * chart.triangles[t] + k] = glm::clamp(glm::vec2(uv), 0.0f, 1.0f);
            }
        }
    }
    return layout;
}

template<typename T>
void pick(std::vector<T>& values, const Numbering<uint64_t>& vertices) {
    if (values.empty()) return;
    std::vector<T> out(vertices.size());
    for (uint32_t i = 0; i < out.size(); ++i)
        out[i] = values[vertices.key(i) >> 32];
    values = std::move(out);
}

/// Writes the UVs of the triangles from `first` on; a vertex in several charts becomes several.
void applyLayout(const Layout& layout, size_t first, Primitive& primitive) {
    Numbering<uint64_t> vertices(primitive.indices.size());
    std::vector<glm::vec2> uvs;
    for (size_t i = 0; i < primitive.indices.size(); ++i) {
        const size_t triangle = first + i / 3;
        const uint64_t key = (uint64_t(primitive.indices[i]) << 32) | layout.chart[triangle];
        primitive.indices[i] = vertices(key, mixBits(key));
        if (primitive.indices[i] == uvs.size()) uvs.push_back(layout.uv[3 * triangle + i % 3]);
    }
    pick(primitive.positions, vertices);
    pick(primitive.normals, vertices);
    pick(primitive.texCoord0, vertices);
    pick(primitive.colors, vertices);
    primitive.texCoord1 = std::move(uvs);
}

void applyLayout(const Layout& layout, Mesh& mesh) {
    size_t first = 0;
    for (Primitive& primitive : mesh.primitives) {
        const size_t count = primitive.indices.size() / 3;
        applyLayout(layout, first, primitive);
        first += count;
    }
}

/// Frees TEXCOORD_1 of a mesh whose textures use it, by moving it to TEXCOORD_0 in copies of the materials.
class TexCoordMover {
public:
    explicit TexCoordMover(Scene& scene) : scene_(scene), copies_(scene.materials.size(), -1) {}
    void run(Mesh& mesh) {
        for (Primitive& primitive : mesh.primitives)
            if (primitive.material >= 0) run(mesh, primitive);
    }

private:
    static constexpr TextureRef Material::*kUses[] = {&Material::baseColorTexture, &Material::emissionTexture,
                                                      &Material::metallicRoughnessTexture};
    void run(const Mesh& mesh, Primitive& primitive) {
        const Material material = scene_.materials[static_cast<size_t>(primitive.material)];
        bool usesSet[2] = {false, false};
        for (TextureRef Material::*use : kUses)
            if ((material.*use).texture >= 0) usesSet[(material.*use).texCoord] = true;
        if (!usesSet[1]) return;
        if (usesSet[0])
            throw Error(fmt::format(
                "{}: mesh {} needs both its UV sets for textures, so none is free for the lightmap: "
                "let its textures share one set",
                scene_.path, inQuotes(mesh.name)));
        if (copies_[static_cast<size_t>(primitive.material)] < 0) {
            copies_[static_cast<size_t>(primitive.material)] = static_cast<int>(scene_.materials.size());
            scene_.materials.push_back(material);
            for (TextureRef Material::*use : kUses)
                (scene_.materials.back().*use).texCoord = 0;
        }
        primitive.material = copies_[static_cast<size_t>(primitive.material)];
        primitive.texCoord0 = primitive.texCoord1;
    }

    Scene& scene_;
    std::vector<int> copies_; // of the scene's own materials, -1: none yet
};

std::string nameOf(const Scene& scene, const Job& job) {
    return scene.path + ": mesh " + inQuotes(scene.meshes[job.mesh].name);
}

/// Returns about the size of a texel [m], as a power of two: charts stay what they are while a scene changes
/// a little.
double texelOf(const UnwrapDesc& desc, double area) {
    const double texel = desc.density > 0.0 ? 1.0 / desc.density : std::sqrt(area / kRectFill) / desc.size;
    return texel > 0.0 && std::isfinite(texel) ? std::exp2(std::round(std::log2(texel))) : 0.0;
}

std::vector<Job> cutMeshes(const Scene& scene, const UnwrapDesc& desc, const std::vector<bool>& chosen) {
    const std::vector<glm::dmat3> transforms = largestTransforms(scene);
    std::vector<double> areas(scene.meshes.size());
    double all = 0.0;
    for (const Instance& instance : scene.instances) {
        const size_t mesh = static_cast<size_t>(instance.mesh);
        const double area = areaOf(cornersOf(scene.meshes[mesh], glm::dmat3(instance.transform)));
        areas[mesh] += area;
        all += area;
    }
    std::vector<Job> jobs;
    for (size_t i = 0; i < scene.meshes.size(); ++i)
        if (chosen[i]) jobs.push_back({i, cornersOf(scene.meshes[i], transforms[i]), {}, 0.0});
    const double texel = texelOf(desc, all);
    WorkerPool pool(0);
    std::atomic<uint32_t> done = 0;
    pool.run(static_cast<uint32_t>(jobs.size()), [&](uint32_t i) {
        tellWatch("unwrapping", double(done++) / double(jobs.size()));
        Job& job = jobs[i];
        job.charts = cutCharts(job.corners, texel, pool);
        const double largest = areaOf(job.corners), ratio = areas[job.mesh] / largest;
        job.instances = largest > 0.0 && std::isfinite(ratio) ? ratio : 1.0;
    });
    std::erase_if(jobs, [](const Job& job) { return job.charts.empty(); }); // triangles without area
    return jobs;
}

/// Returns the jobs' share of the scene's area; meshes that keep their UVs need the rest.
double shareOf(const Scene& scene, const std::vector<Job>& jobs) {
    double own = 0.0, all = 0.0;
    for (const Job& job : jobs)
        own += job.instances * areaOf(job.corners);
    for (const Instance& instance : scene.instances)
        all += areaOf(
            cornersOf(scene.meshes[static_cast<size_t>(instance.mesh)], glm::dmat3(instance.transform)));
    return own > 0.0 && own < all ? own / all : 1.0;
}

/// Returns how many texels all instances need together at a density, gutters included.
double texelsAt(const std::vector<Job>& jobs, double density) {
    double texels = 0.0;
    for (const Job& job : jobs) {
        const double side = packCharts(job.charts, density).side;
        texels += job.instances * side * side;
    }
    return texels;
}

/// Returns the density, or the next lower one by halves at which no mesh needs more texels than it can have;
/// a mesh may be far longer than its area tells. No density helps where there are too many charts.
double allowedDensity(const std::vector<Job>& jobs, double density) {
    const auto allowed = [&] {
        return std::all_of(jobs.begin(), jobs.end(),
                           [&](const Job& job) { return chartArea(job.charts, density).has_value(); });
    };
    while (density > 0.0 && !allowed())
        density *= 0.5;
    return density;
}

void warnAboutLongest(const Scene& scene, const std::vector<Job>& jobs, double density) {
    const auto longest = std::find_if(jobs.begin(), jobs.end(),
                                      [&](const Job& job) { return !chartArea(job.charts, density); });
    spdlog::warn(
        "{} is so long that all others get very few texels, or none would be left for them: cut it up, take "
        "it out of the scene or pass --density",
        nameOf(scene, *longest));
}

/// Returns the density at which `texels` texels hold the instances of all jobs, with their gutters at full
/// width.
double densityThatFits(const Scene& scene, const std::vector<Job>& jobs, double texels) {
    double area = 0.0;
    size_t charts = 0;
    for (const Job& job : jobs) {
        area += job.instances * areaOf(job.corners);
        charts += job.charts.size();
    }
    const double start = area > 0.0 && std::isfinite(area) ? std::sqrt(kFill * texels / area) : 1.0;
    double density = allowedDensity(jobs, start), best = 0.0;
    if (density < start) warnAboutLongest(scene, jobs, start);
    const int steps = charts > kManyCharts ? 2 : kSearchSteps;
    for (int step = 0; step < steps && density > 0.0; ++step) {
        const double need = texelsAt(jobs, density);
        if (need <= texels) best = std::max(best, density);
        density *= std::sqrt(texels / need);
        // Packings jump, so the density creeps up on the limit from below once one has been met.
        if (best > 0.0 && density <= best) density = best * 1.01;
        density = allowedDensity(jobs, density);
    }
    return best > 0.0 ? best : density;
}

void unwrapMesh(Scene& scene, Job& job, const UnwrapDesc& desc, bool alone, UnwrapResult& result) {
    Mesh& mesh = scene.meshes[job.mesh];
    const Mesh original = mesh;
    for (bool single : {false, true}) {
        // Overlap finer than the grid that looks for it adds up in no known mesh; single triangles cannot
        // overlap.
        if (single) job.charts = cutSingleTriangles(job.corners);
        if (!chartArea(job.charts, result.density))
            throw Error(fmt::format("{} needs more than {} texels a side at {:.4g} texels/m: {}",
                                    nameOf(scene, job), kMaxTexels, result.density,
                                    desc.density > 0.0 ? "use a lower --density"
                                                       : "pass a lower --density than that"));
        const Packing packing = packCharts(job.charts, result.density);
        // A mesh alone in its scene is the atlas: its texels shall be those of the lightmap.
        const bool aligned = alone && desc.density <= 0.0 && packing.side <= desc.size;
        mesh = original;
        applyLayout(layOut(job, packing, aligned ? desc.size : packing.side), mesh);
        if (lightmapSet(mesh) == 1) break;
    }
    ++result.meshes;
    result.charts += static_cast<uint32_t>(job.charts.size());
}

bool hasArea(const Primitive& primitive, const glm::dmat3& linear) {
    for (size_t i = 0; i + 2 < primitive.indices.size(); i += 3) {
        const auto corner = [&](size_t k) {
            return linear * glm::dvec3(primitive.positions[primitive.indices[i + k]]);
        };
        if (glm::length(glm::cross(corner(1) - corner(0), corner(2) - corner(0))) > 0.0) return true;
    }
    return false;
}

} // namespace

void requireArea(const Scene& scene) {
    for (const Instance& instance : scene.instances)
        for (const Primitive& primitive : scene.meshes[static_cast<size_t>(instance.mesh)].primitives)
            if (hasArea(primitive, glm::dmat3(glm::mat3(instance.transform)))) return;
    throw Error(scene.path + ": has no triangle with an area: export it with its geometry");
}

UnwrapResult unwrap(Scene& scene, const UnwrapDesc& desc) {
    std::vector<bool> chosen(scene.meshes.size());
    TexCoordMover mover(scene);
    for (size_t i = 0; i < scene.meshes.size(); ++i) {
        chosen[i] =
            !scene.meshes[i].primitives.empty() && !(desc.onlyMissing && lightmapSet(scene.meshes[i]) >= 0);
        if (chosen[i]) mover.run(scene.meshes[i]);
    }
    std::vector<Job> jobs = cutMeshes(scene, desc, chosen);
    const bool alone = scene.instances.size() == 1;
    const double texels = (alone ? 1.0 : kRectFill) * desc.size * desc.size * shareOf(scene, jobs);
    UnwrapResult result;
    if (jobs.empty()) return result;
    result.density = desc.density > 0.0 ? desc.density : densityThatFits(scene, jobs, texels);
    for (Job& job : jobs)
        unwrapMesh(scene, job, desc, alone, result);
    return result;
}

} // namespace relume
