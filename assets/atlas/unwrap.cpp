#include "assets/atlas/unwrap.h"

#include "assets/atlas/lightmap_atlas.h"
#include "assets/atlas/page_deal.h"
#include "assets/atlas/page_layout.h"
#include "assets/atlas/unwrap_shapes.h"
#include "assets/atlas/uv_sets.h"
#include "assets/atlas/uv_writer.h"
#include "assets/base/error.h"
#include "assets/base/warnings.h"
#include "assets/base/watch.h"

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

namespace relume {

namespace {

constexpr uint32_t kMostTexels = 16384; // to a side of an atlas whose size the density decides
constexpr uint32_t kLeastSize = 64;     // of a lightmap [texels]
constexpr double kTold = 0.995;         // of the density asked for: less is worth a warning

std::string nameOf(const Scene& scene, const Mesh& mesh) {
    return scene.path + ": mesh " + inQuotes(mesh.name);
}

bool isStillUsed(const std::vector<ChartLayout>& now, const std::vector<ChartLayout>& before) {
    uint64_t touched = 0, touchedBefore = 0;
    for (const ChartLayout& layout : now)
        touched += layout.touched;
    for (const ChartLayout& layout : before)
        touchedBefore += layout.touched;
    return static_cast<double>(touched) >= kStillUsed * static_cast<double>(touchedBefore);
}

/// Makes the UVs of one scene.
class Unwrapper {
public:
    Unwrapper(Scene& scene, const UnwrapDesc& desc, UnwrapMemory* memory)
        : scene_(scene), desc_(desc), memory_(memory), pool_(desc.threads) {}
    UnwrapResult run();

private:
    bool choose();
    void sizeTexels();
    void cut();
    ObjectCharts charts() const;
    double densityOf(const UnwrapObject& object) const;
    uint32_t chooseSize(const ObjectCharts& charts) const;
    [[noreturn]] void failForTooLarge(const std::vector<LayoutChart>& charts) const;
    void layOut();
    /// Lays the charts out where the memory has them; returns false where that does not go.
    bool layOutAgain(const ObjectCharts& charts);
    std::vector<std::optional<ChartPlace>> remembered(const ObjectCharts& charts);
    void scaleByShare(ObjectCharts& charts) const;
    void dealTheRest(const ObjectCharts& charts, const std::vector<std::optional<ChartPlace>>& places);
    PagedDesc paged() const { return {size_, desc_.density, pages_}; }
    void tell();
    bool write();
    void remember();

    Scene& scene_;
    const UnwrapDesc& desc_;
    UnwrapMemory* memory_;
    WorkerPool pool_;
    std::vector<bool> chosen_;
    std::vector<int> keptSet_; // per mesh, -1: it is cut, or left alone
    UnwrapParts parts_;
    std::vector<size_t> rememberedShape_; // per shape; memory's count: none
    uint32_t size_ = 0;                   // of a page
    uint32_t pages_ = 1;
    std::vector<uint32_t> page_; // per object
    std::vector<double> share_;  // per object, of its density (UnwrapMemory::Object)
    PagedLayout layout_;
    UnwrapResult result_;
};

/// Chooses the meshes to cut, and those whose UVs are kept; returns whether any is cut.
bool Unwrapper::choose() {
    const size_t count = scene_.meshes.size();
    std::vector<int> set(count, -1);
    tellWatch("unwrapping", 0.0); // helpers may take all of the work below, and nobody hears them
    pool_.run(static_cast<uint32_t>(count), [&](uint32_t i) {
        if (desc_.onlyMissing) set[i] = lightmapSet(scene_.meshes[i]);
    });
    chosen_.assign(count, false);
    keptSet_.assign(count, -1);
    Warnings warnings;
    bool any = false;
    for (const Instance& instance : scene_.instances) {
        const auto i = static_cast<size_t>(instance.mesh);
        const Mesh& mesh = scene_.meshes[i];
        if (mesh.primitives.empty()) continue;
        if (!canFreeSecondSet(scene_, mesh)) {
            if (set[i] < 0)
                warnings.add("mesh " + inQuotes(mesh.name),
                             "needs three UV sets for textures, so none is free for the lightmap: let its "
                             "textures share one set");
            continue;
        }
        chosen_[i] = set[i] < 0;
        keptSet_[i] = set[i];
        any |= chosen_[i];
    }
    for (const std::string& line : warnings.lines(scene_.path))
        spdlog::warn("{}", line);
    return any;
}

/// Tells each shape about how large a texel will be on it, as a power of two: charts stay what they are while
/// a scene changes a little.
void Unwrapper::sizeTexels() {
    std::vector<double> largest(parts_.shapes.size()), areas(parts_.shapes.size());
    pool_.run(static_cast<uint32_t>(areas.size()), [&](uint32_t i) {
        areas[i] = relume::areaOf(scene_.meshes[parts_.meshOf[i]], parts_.shapes[i]);
    });
    double area = 0.0;
    for (const UnwrapObject& object : parts_.objects) {
        const double scale = object.scale * densityOf(object);
        largest[object.shape] = std::max(largest[object.shape], scale);
        area += areas[object.shape] * scale * scale;
    }
    const bool bySize = desc_.size > 0 && desc_.pages > 0;
    double texel = bySize ? std::sqrt(area / desc_.pages / kUsualFill) / desc_.size : 0.0;
    if (desc_.density > 0.0) texel = std::max(texel, 1.0 / desc_.density);
    for (size_t i = 0; i < largest.size(); ++i) {
        const double own = std::exp2(std::round(std::log2(texel / largest[i])));
        parts_.shapes[i].texel = own > 0.0 && std::isfinite(own) ? own : 0.0;
    }
}

/// Cuts each shape into charts, or takes them from the memory.
void Unwrapper::cut() {
    parts_ = collectParts(scene_, chosen_, keptSet_);
    sizeTexels();
    const size_t known = memory_ ? memory_->shapes.size() : 0;
    rememberedShape_.assign(parts_.shapes.size(), known);
    std::multimap<uint64_t, size_t> byHash;
    for (size_t i = 0; i < known; ++i)
        byHash.emplace(memory_->shapes[i].hash, i);
    std::vector<bool> taken(known);
    for (size_t i = 0; i < parts_.shapes.size(); ++i) {
        const auto [begin, end] = byHash.equal_range(parts_.shapes[i].hash);
        for (auto it = begin; it != end && rememberedShape_[i] == known; ++it) {
            if (taken[it->second] || !sameShape(parts_.shapes[i], memory_->shapes[it->second])) continue;
            taken[it->second] = true;
            rememberedShape_[i] = it->second;
            parts_.shapes[i] = memory_->shapes[it->second];
        }
    }
    pool_.run(static_cast<uint32_t>(parts_.shapes.size()), [&](uint32_t i) {
        tellWatch("unwrapping", double(i) / double(parts_.shapes.size()));
        const size_t mesh = parts_.meshOf[i];
        if (rememberedShape_[i] == known)
            cutShape(scene_.meshes[mesh], keptSet_[mesh], parts_.shapes[i], pool_);
    });
    // What has no chart is nothing but triangles without area.
    std::erase_if(parts_.objects,
                  [&](const UnwrapObject& o) { return parts_.shapes[o.shape].charts.empty(); });
}

double Unwrapper::densityOf(const UnwrapObject& object) const {
    return scene_.instances[object.instance].density;
}

ObjectCharts Unwrapper::charts() const {
    ObjectCharts charts;
    for (const UnwrapObject& object : parts_.objects) {
        charts.first.push_back(charts.charts.size());
        for (const PlanarChart& chart : parts_.shapes[object.shape].charts)
            charts.charts.push_back({&chart, object.scale * densityOf(object)});
    }
    return charts;
}

uint32_t Unwrapper::chooseSize(const ObjectCharts& charts) const {
    if (desc_.size > 0) return desc_.size;
    const std::optional<uint32_t> size = sizeForPages(charts, paged(), kMostTexels);
    if (!size) failForTooLarge(charts.charts);
    return *size;
}

/// Throws the Error for a density that needs too large an atlas; it names the mesh of the longest chart.
void Unwrapper::failForTooLarge(const std::vector<LayoutChart>& charts) const {
    const auto longest =
        std::max_element(charts.begin(), charts.end(), [](const LayoutChart& a, const LayoutChart& b) {
            const auto side = [](const LayoutChart& c) {
                return c.scale * std::max(c.chart->extent.x, c.chart->extent.y);
            };
            return side(a) < side(b);
        });
    size_t first = 0;
    for (const UnwrapObject& object : parts_.objects) {
        first += parts_.shapes[object.shape].charts.size();
        if (first > static_cast<size_t>(longest - charts.begin()))
            throw Error(fmt::format(
                "{}, the longest, and all others need more than {} texels a side at {:.4g} "
                "texels/m: use a lower --density",
                nameOf(scene_, scene_.meshes[parts_.meshOf[object.shape]]), kMostTexels, desc_.density));
    }
    throw Error(scene_.path + ": has no charts");
}

/// Returns the places that charts of objects had, by the objects' names first and their order else, and notes
/// their pages and shares.
std::vector<std::optional<ChartPlace>> Unwrapper::remembered(const ObjectCharts& charts) {
    std::vector<std::optional<ChartPlace>> places(charts.charts.size());
    std::map<std::pair<size_t, std::string>, std::vector<size_t>> named; // the last first
    std::map<size_t, std::vector<size_t>> all;
    for (size_t i = memory_->objects.size(); i-- > 0;) {
        const UnwrapMemory::Object& object = memory_->objects[i];
        named[{object.shape, object.name}].push_back(i);
        all[object.shape].push_back(i);
    }
    std::vector<bool> used(memory_->objects.size());
    for (const bool byName : {true, false})
        for (size_t i = 0; i < parts_.objects.size(); ++i) {
            const UnwrapObject& object = parts_.objects[i];
            if (places[charts.first[i]]) continue;
            const size_t shape = rememberedShape_[object.shape];
            std::vector<size_t>& from =
                byName ? named[{shape, scene_.instances[object.instance].name}] : all[shape];
            while (!from.empty() && used[from.back()])
                from.pop_back();
            if (from.empty()) continue;
            used[from.back()] = true;
            page_[i] = memory_->objects[from.back()].page;
            share_[i] = memory_->objects[from.back()].share;
            const std::vector<ChartPlace>& own = memory_->objects[from.back()].places;
            std::copy(own.begin(), own.end(), places.begin() + static_cast<std::ptrdiff_t>(charts.first[i]));
        }
    return places;
}

/// Deals the objects that have no place to the pages with the most room.
void Unwrapper::dealTheRest(const ObjectCharts& charts,
                            const std::vector<std::optional<ChartPlace>>& places) {
    const std::vector<double> areas = charts.areas();
    std::vector<double> load(pages_, 0.0), unplaced;
    std::vector<size_t> without;
    for (size_t i = 0; i < areas.size(); ++i)
        if (places[charts.first[i]]) {
            load[page_[i]] += areas[i];
        } else {
            without.push_back(i);
            unplaced.push_back(areas[i]);
        }
    const std::vector<uint32_t> dealt = dealToPages(unplaced, pages_, load);
    for (size_t i = 0; i < without.size(); ++i)
        page_[without[i]] = dealt[i];
}

void Unwrapper::scaleByShare(ObjectCharts& charts) const {
    for (size_t i = 0; i < charts.objects(); ++i)
        for (size_t c = charts.first[i]; c < charts.end(i); ++c)
            charts.charts[c].scale *= share_[i];
}

bool Unwrapper::layOutAgain(const ObjectCharts& charts) {
    if (!memory_ || memory_->size != size_ || memory_->asked != desc_.density ||
        memory_->layouts.size() != pages_ || size_ == 0)
        return false;
    page_.assign(parts_.objects.size(), 0);
    share_.assign(parts_.objects.size(), 1.0);
    std::vector<std::optional<ChartPlace>> places = remembered(charts);
    ObjectCharts shared = charts;
    scaleByShare(shared);
    // An object that is smaller or larger now looks for a new place; all its charts do.
    for (size_t i = 0; i < parts_.objects.size(); ++i) {
        const size_t begin = charts.first[i], end = charts.end(i);
        bool same = places[begin].has_value();
        for (size_t c = begin; same && c < end; ++c)
            same = isAsBefore(shared.charts[c], memory_->layouts[page_[i]], innerSize(paged()), *places[c]);
        for (size_t c = begin; !same && c < end; ++c)
            places[c].reset();
        result_.stayed += same;
    }
    dealTheRest(charts, places);
    for (const double share : kShares) {
        for (size_t i = 0; i < parts_.objects.size(); ++i)
            if (!places[charts.first[i]]) share_[i] = share;
        shared = charts;
        scaleByShare(shared);
        std::optional<PagedLayout> layout = extendPages(shared, paged(), memory_->layouts, page_, places);
        if (!layout) continue;
        if (!isStillUsed(layout->layouts, memory_->layouts)) break;
        layout_ = std::move(*layout);
        return true;
    }
    share_.assign(parts_.objects.size(), 1.0);
    result_.stayed = 0;
    return false;
}

void Unwrapper::layOut() {
    const ObjectCharts all = charts();
    const bool known = memory_ && memory_->size > 0 && memory_->asked == desc_.density;
    pages_ = desc_.pages > 0 ? desc_.pages : known ? static_cast<uint32_t>(memory_->layouts.size()) : 1;
    size_ = desc_.size > 0 ? desc_.size : known ? memory_->size : 0;
    share_.assign(parts_.objects.size(), 1.0);
    if (layOutAgain(all)) return;
    size_ = chooseSize(all);
    try {
        layout_ = desc_.pages == 0 ? layOutByDensity(all, paged(), pool_) : layOutPages(all, paged(), pool_);
    } catch (const Error& error) {
        throw Error(scene_.path + ": " + error.what());
    }
    pages_ = layout_.pages.count;
}

/// Writes the UVs; returns whether all meshes that were cut are valid atlases.
bool Unwrapper::write() {
    std::vector<Mesh> meshes(parts_.objects.size());
    std::vector<uint8_t> valid(meshes.size(), 1);
    const std::vector<size_t> first = charts().first;
    const uint32_t border = borderOf(layout_.pages);
    pool_.run(static_cast<uint32_t>(meshes.size()), [&](uint32_t i) {
        tellWatch("unwrapping", double(i) / double(meshes.size()));
        const double texel = layout_.layouts[layout_.page[i]].texel;
        const UnwrapObject& object = parts_.objects[i];
        const Mesh& mesh = scene_.meshes[parts_.meshOf[object.shape]];
        size_t triangles = 0;
        for (const Primitive& primitive : mesh.primitives)
            triangles += primitive.indices.size() / 3;
        meshes[i] = withUvs(mesh, cornerUvs(parts_.shapes[object.shape].charts, &layout_.places[first[i]],
                                            size_ / texel, border / texel, triangles));
        valid[i] = lightmapSet(meshes[i]) == 1;
    });
    bool again = false; // overlap finer than the grid that looks for it adds up in no known mesh
    for (size_t i = 0; i < meshes.size(); ++i) {
        UnwrapShape& shape = parts_.shapes[parts_.objects[i].shape];
        if (valid[i] || shape.kept || shape.cutUp) continue;
        again = shape.cutUp = true;
        cutShapeUp(scene_.meshes[parts_.meshOf[parts_.objects[i].shape]], shape);
    }
    if (again) return false;
    std::vector<bool> written(scene_.meshes.size());
    for (size_t i = 0; i < meshes.size(); ++i) {
        Instance& instance = scene_.instances[parts_.objects[i].instance];
        instance.page = layout_.page[i];
        const auto mesh = static_cast<size_t>(instance.mesh);
        if (written[mesh]) {
            instance.mesh = static_cast<int>(scene_.meshes.size());
            scene_.meshes.push_back(std::move(meshes[i]));
        } else {
            written[mesh] = true;
            scene_.meshes[mesh] = std::move(meshes[i]);
            result_.meshes += chosen_[mesh];
        }
    }
    return true;
}

void Unwrapper::remember() {
    memory_->size = size_;
    memory_->asked = desc_.density;
    memory_->objects.clear();
    const ObjectCharts all = charts();
    for (size_t i = 0; i < parts_.objects.size(); ++i) {
        const UnwrapObject& object = parts_.objects[i];
        const auto begin = layout_.places.begin();
        memory_->objects.push_back({scene_.instances[object.instance].name,
                                    object.shape,
                                    layout_.page[i],
                                    {begin + static_cast<std::ptrdiff_t>(all.first[i]),
                                     begin + static_cast<std::ptrdiff_t>(all.end(i))},
                                    share_[i]});
    }
    memory_->shapes = std::move(parts_.shapes);
    memory_->layouts = std::move(layout_.layouts);
}

UnwrapResult Unwrapper::run() {
    if (!choose()) return result_;
    for (size_t i = 0; i < chosen_.size(); ++i)
        if (chosen_[i] || keptSet_[i] >= 0) freeSecondSet(scene_, scene_.meshes[i]);
    cut();
    if (std::none_of(parts_.objects.begin(), parts_.objects.end(),
                     [&](const UnwrapObject& o) { return !parts_.shapes[o.shape].kept; }))
        return result_;
    do
        layOut();
    while (!write());
    scene_.pages = pages_;
    tell();
    if (memory_) remember();
    return result_;
}

/// Fills the result, and warns about what fell short.
void Unwrapper::tell() {
    result_.objects = static_cast<uint32_t>(parts_.objects.size());
    result_.charts = static_cast<uint32_t>(layout_.places.size());
    result_.size = size_;
    result_.pages = pages_;
    result_.density = result_.leastDensity = layout_.density();
    for (const double share : share_) {
        result_.coarser += share < 1.0;
        result_.leastShare = std::min(result_.leastShare, share);
    }
    for (const ChartLayout& layout : layout_.layouts) {
        result_.shortened += layout.shortened;
        if (layout.shortened > 0)
            result_.leastDensity = std::min(result_.leastDensity, layout.density * layout.leastShare);
        const double cells = double(size_) * size_ * pages_ / (double(layout.texel) * layout.texel);
        result_.covered += static_cast<double>(layout.touched) / cells;
        result_.reserved += static_cast<double>(layout.reserved) / cells;
    }
    const std::string pages = pages_ > 1 ? fmt::format("{} pages of ", pages_) : "";
    if (desc_.density > 0.0 && result_.density < kTold * desc_.density)
        spdlog::warn("{}: {:.4g} texels/m do not fit {}{} x {} texels, {:.4g} do: use a larger --size",
                     scene_.path, desc_.density, pages, size_, size_, result_.density);
    if (const uint32_t empty = layout_.emptyPages(); empty > 0)
        spdlog::warn("{}: {} of {} pages stay empty, as an object lies on one page and there are {}: use "
                     "fewer --pages",
                     scene_.path, empty, pages_, parts_.objects.size());
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

double surfaceArea(const Scene& scene) {
    double area = 0.0;
    for (const Instance& instance : scene.instances) {
        if (instance.hidden) continue;
        const glm::dmat3 linear(glm::mat3(instance.transform));
        for (const Primitive& primitive : scene.meshes[static_cast<size_t>(instance.mesh)].primitives)
            for (size_t i = 0; i + 2 < primitive.indices.size(); i += 3) {
                const glm::dvec3 a = primitive.positions[primitive.indices[i]],
                                 b = primitive.positions[primitive.indices[i + 1]],
                                 c = primitive.positions[primitive.indices[i + 2]];
                area += 0.5 * glm::length(glm::cross(linear * (b - a), linear * (c - a)));
            }
    }
    return area;
}

void requireArea(const Scene& scene) {
    for (const Instance& instance : scene.instances)
        for (const Primitive& primitive : scene.meshes[static_cast<size_t>(instance.mesh)].primitives)
            if (hasArea(primitive, glm::dmat3(glm::mat3(instance.transform)))) return;
    throw Error(scene.path + ": has no triangle with an area: export it with its geometry");
}

UnwrapResult unwrap(Scene& scene, const UnwrapDesc& desc, UnwrapMemory* memory) {
    if (desc.size == 0 && !(desc.density > 0.0)) throw Error("an unwrap needs a size or a density");
    if (desc.pages == 0 && (desc.size == 0 || !(desc.density > 0.0)))
        throw Error("an unwrap needs a size and a density to choose the number of pages by");
    ASSERT(desc.pages <= kMostPages);
    return Unwrapper(scene, desc, memory).run();
}

uint32_t sizeForDensity(double area, double density, double coverage, uint32_t maximum, uint32_t stride) {
    const double least = std::min(kLeastSize, maximum);
    if (area <= 0.0 || density <= 0.0) return static_cast<uint32_t>(least);
    const double edge = density * std::sqrt(area / coverage);
    if (!(coverage > 0.0) || !std::isfinite(edge)) return maximum;
    double size = least;
    while (size < edge && size < maximum)
        size *= 2.0;
    if (stride > 0) size = std::min(size, std::max(least, std::ceil(edge / stride) * stride));
    return static_cast<uint32_t>(std::min(size, double(maximum)));
}

} // namespace relume
