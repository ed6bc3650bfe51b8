#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "assets/atlas/chart_layout.h"
#include "assets/model/lightmap_pages.h"

namespace relume {

/// The share of a page that charts usually cover, for a first guess.
constexpr double kUsualFill = 0.85;

/// The charts of all objects that look for places, object by object.
struct ObjectCharts {
    std::vector<LayoutChart> charts;
    std::vector<size_t> first; // of each object's charts

    size_t objects() const { return first.size(); }
    size_t end(size_t object) const { return object + 1 < first.size() ? first[object + 1] : charts.size(); }
    /// Returns the area of each object (see areaOf).
    std::vector<double> areas() const;
};

struct PagedDesc {
    uint32_t size = 0;    // of a page [texels]
    double density = 0.0; // [texels/m]; 0, or more than fits: the most that fits
    uint32_t pages = 1;
};

/// Holds all charts in their places on pages.
struct PagedLayout {
    LightmapPages pages;
    std::vector<uint32_t> page;       // per object
    std::vector<ChartPlace> places;   // per chart, within its page and without the border (borderOf)
    std::vector<ChartLayout> layouts; // per page, without the places

    /// Returns the least density of the pages that have charts [texels/m]; 0: none has.
    double density() const;
    uint32_t emptyPages() const;
};

/// Deals the objects to pages (dealToPages) and lays out each page at one density. The pages that could be
/// denser than the fullest are as dense as it. With one page this is layOutCharts(). Throws Error as that
/// does.
PagedLayout layOutPages(const ObjectCharts& objects, const PagedDesc& desc, WorkerPool& pool);

/// Does the same on as many pages as the density needs, as far as more pages help; desc.pages does not count.
PagedLayout layOutByDensity(const ObjectCharts& objects, PagedDesc desc, WorkerPool& pool);

/// Places the charts that have no place yet beside those that have one, page by page (extendLayout); `page`
/// holds the page of each object. Returns nothing where that does not go.
std::optional<PagedLayout> extendPages(const ObjectCharts& objects, const PagedDesc& desc,
                                       std::span<const ChartLayout> before, std::vector<uint32_t> page,
                                       std::span<const std::optional<ChartPlace>> places);

/// Returns the edge of a page that takes all charts at the density, as the objects are dealt to the pages
/// [texels]; nothing where it would be longer than `most`.
std::optional<uint32_t> sizeForPages(const ObjectCharts& objects, const PagedDesc& desc, uint32_t most);

/// Returns the edge of the square in which charts lie on a page. Throws Error where there is none.
uint32_t innerSize(const PagedDesc& desc);

} // namespace relume
