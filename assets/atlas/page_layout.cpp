#include "assets/atlas/page_layout.h"

#include "assets/atlas/page_deal.h"
#include "assets/base/error.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace relume {

namespace {

constexpr double kAsDense = 0.995; // of a density: what is above it is worth no other layout

/// Returns the numbers of the charts that lie on a page, ascending.
std::vector<size_t> chartsOn(const ObjectCharts& objects, std::span<const uint32_t> pages, uint32_t page) {
    std::vector<size_t> charts;
    for (size_t i = 0; i < objects.objects(); ++i)
        if (pages[i] == page)
            for (size_t c = objects.first[i]; c < objects.end(i); ++c)
                charts.push_back(c);
    return charts;
}

std::vector<LayoutChart> pick(const ObjectCharts& objects, std::span<const size_t> numbers) {
    std::vector<LayoutChart> charts;
    for (const size_t c : numbers)
        charts.push_back(objects.charts[c]);
    return charts;
}

bool hasCharts(const ChartLayout& layout) {
    return layout.reserved > 0;
}

/// Puts a page's layout into that of all.
void put(PagedLayout& all, uint32_t page, std::span<const size_t> numbers, ChartLayout layout) {
    for (size_t i = 0; i < numbers.size(); ++i)
        all.places[numbers[i]] = layout.places[i];
    layout.places.clear();
    all.layouts[page] = std::move(layout);
}

void layOutPage(const ObjectCharts& objects, uint32_t page, const LayoutDesc& desc, WorkerPool& pool,
                PagedLayout& all) {
    const std::vector<size_t> numbers = chartsOn(objects, all.page, page);
    put(all, page, numbers, layOutCharts(pick(objects, numbers), desc, pool));
}

PagedLayout emptyLayout(const ObjectCharts& objects, uint32_t pages) {
    PagedLayout all{.pages = {pages}, .page = {}, .places = {}, .layouts = {}};
    all.places.resize(objects.charts.size());
    all.layouts.resize(pages);
    return all;
}

} // namespace

std::vector<double> ObjectCharts::areas() const {
    std::vector<double> areas(objects(), 0.0);
    for (size_t i = 0; i < areas.size(); ++i)
        for (size_t c = first[i]; c < end(i); ++c)
            areas[i] += areaOf(charts[c]);
    return areas;
}

double PagedLayout::density() const {
    double least = HUGE_VAL;
    for (const ChartLayout& layout : layouts)
        if (hasCharts(layout)) least = std::min(least, layout.density);
    return std::isfinite(least) ? least : 0.0;
}

uint32_t PagedLayout::emptyPages() const {
    return static_cast<uint32_t>(std::count_if(layouts.begin(), layouts.end(),
                                               [](const ChartLayout& layout) { return !hasCharts(layout); }));
}

uint32_t innerSize(const PagedDesc& desc) {
    const uint32_t borders = 2 * borderOf({desc.pages});
    if (desc.size > borders) return desc.size - borders;
    throw Error(
        fmt::format("pages of {} x {} texels are all border: use a larger --size", desc.size, desc.size));
}

PagedLayout layOutPages(const ObjectCharts& objects, const PagedDesc& desc, WorkerPool& pool) {
    PagedLayout all = emptyLayout(objects, desc.pages);
    all.page = dealToPages(objects.areas(), desc.pages);
    const uint32_t inner = innerSize(desc);
    for (uint32_t page = 0; page < desc.pages; ++page)
        layOutPage(objects, page, {inner, desc.density}, pool, all);
    const double common = all.density();
    for (uint32_t page = 0; page < desc.pages; ++page)
        if (hasCharts(all.layouts[page]) && kAsDense * all.layouts[page].density > common)
            layOutPage(objects, page, {inner, common}, pool, all);
    return all;
}

PagedLayout layOutByDensity(const ObjectCharts& objects, PagedDesc desc, WorkerPool& pool) {
    const std::vector<double> areas = objects.areas();
    const double area = std::accumulate(areas.begin(), areas.end(), 0.0);
    const auto most =
        static_cast<uint32_t>(std::clamp<size_t>(objects.objects(), 1, kMostPages)); // the rest stays empty
    desc.pages = std::min(pagesForDensity(area, desc.density, kUsualFill, desc.size), most);
    PagedLayout best = layOutPages(objects, desc, pool);
    while (best.density() < kAsDense * desc.density && desc.pages < most) {
        ++desc.pages;
        PagedLayout next = layOutPages(objects, desc, pool);
        // An object that needs a page for itself alone is no denser on one of more.
        if (!(next.density() > best.density())) break;
        best = std::move(next);
    }
    return best;
}

std::optional<PagedLayout> extendPages(const ObjectCharts& objects, const PagedDesc& desc,
                                       std::span<const ChartLayout> before, std::vector<uint32_t> page,
                                       std::span<const std::optional<ChartPlace>> places) {
    ASSERT(before.size() == desc.pages && page.size() == objects.objects());
    PagedLayout all = emptyLayout(objects, desc.pages);
    all.page = std::move(page);
    for (uint32_t p = 0; p < desc.pages; ++p) {
        const std::vector<size_t> numbers = chartsOn(objects, all.page, p);
        if (!numbers.empty() && !hasCharts(before[p])) return std::nullopt; // it has no density yet
        std::vector<std::optional<ChartPlace>> had;
        for (const size_t c : numbers)
            had.push_back(places[c]);
        std::optional<ChartLayout> layout =
            extendLayout(pick(objects, numbers), {innerSize(desc), desc.density}, before[p], had);
        if (!layout) return std::nullopt;
        put(all, p, numbers, std::move(*layout));
    }
    return all;
}

std::optional<uint32_t> sizeForPages(const ObjectCharts& objects, const PagedDesc& desc, uint32_t most) {
    const std::vector<uint32_t> dealt = dealToPages(objects.areas(), desc.pages);
    const uint32_t borders = 2 * borderOf({desc.pages});
    uint32_t size = 0;
    for (uint32_t page = 0; page < desc.pages; ++page) {
        const std::vector<LayoutChart> own = pick(objects, chartsOn(objects, dealt, page));
        if (own.empty()) continue;
        const std::optional<uint32_t> least = sizeForCharts(own, desc.density, most - borders);
        if (!least) return std::nullopt;
        size = std::max(size, *least + borders);
    }
    // Pages consist of whole tiles.
    return desc.pages > 1 ? (size + kPageStep - 1) / kPageStep * kPageStep : size;
}

} // namespace relume
