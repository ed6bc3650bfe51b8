#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "assets/atlas/planar_charts.h"
#include "assets/base/worker_pool.h"

namespace relume {

/// A chart that looks for a place in the atlas.
struct LayoutChart {
    const PlanarChart* chart = nullptr;
    double scale = 1.0; // [1], of its metres: of the instance, times its own density factor
};

/// A chart's place in the atlas. It turns by quarters only and is never mirrored, so that straight borders
/// stay on the edges of texels.
struct ChartPlace {
    glm::uvec2 corner{0};    // the least texel of its box as it lies in the atlas
    glm::uvec2 box{0};       // [texels], before it is turned
    uint32_t turns = 0;      // by 90 degrees: (x, y) goes to (height - y, x)
    glm::dvec2 inset{0.0};   // [texels], of the chart in its box
    glm::dvec2 stretch{0.0}; // [texels/m], along the chart's axes

    /// Returns the texels, of the atlas, of a point of the chart [m].
    glm::dvec2 texelOf(glm::dvec2 uv) const;
    bool operator==(const ChartPlace&) const = default;
};

struct LayoutDesc {
    uint32_t size = 0;    // of the atlas [texels]
    double density = 0.0; // [texels/m]; 0, or more than fits: the most that fits
};

/// Holds all charts in their places. In an atlas of more than 2048 texels they lie on a coarser grid, of
/// `texel` texels to a cell; places count cells.
struct ChartLayout {
    double density = 0.0;           // [texels/m]
    double aspect = 1.0;            // texels are so much wider than high: at most 4 % off, where it helps
    uint32_t texel = 1;             // [texels] to a cell
    uint64_t touched = 0;           // cells that charts touch
    uint64_t reserved = 0;          // these and the gutters that are theirs
    uint32_t shortened = 0;         // charts that are longer than the atlas, and as long as it here
    double leastShare = 1.0;        // of the density, which one of these has along itself
    std::vector<ChartPlace> places; // one for each chart
};

/// Packs the charts' true shapes. No texel is touched by two charts, and none that bilinear filters read for
/// a chart, with more than 1/256 of the weight, is touched or read by another one: between borders on the
/// edges of texels there are 2 empty texels. A chart that is narrower than 16 texels ends on the centres of
/// texels, where filters read nothing beyond: such charts lie side by side, and each covers the centres of
/// all its texels. A side shorter than half a texel needs no gutter either: it lies in the middle of its
/// texel, where filters see little of the neighbours. Other sides are rounded to whole texels. The result is
/// the same on any number of threads. Throws Error, its message without a subject, where there are more
/// charts than texels.
ChartLayout layOutCharts(std::span<const LayoutChart> charts, const LayoutDesc& desc, WorkerPool& pool);

/// Places the charts that have no place yet beside those that have one, at the density and in the aspect of
/// `layout`. Returns nothing where they do not fit, or where a given place is not free.
std::optional<ChartLayout> extendLayout(std::span<const LayoutChart> charts, const LayoutDesc& desc,
                                        const ChartLayout& layout,
                                        std::span<const std::optional<ChartPlace>> places);

/// Returns the area of a chart as its instance has it [m^2], times its density factor squared.
double areaOf(const LayoutChart& chart);

/// Tells whether a chart would get a box as large as that of its place in such a layout.
bool isAsBefore(const LayoutChart& chart, const ChartLayout& layout, uint32_t size, const ChartPlace& place);

/// Returns the edge of the least atlas that takes the charts at the density [texels], or nothing where it
/// would be longer than `most`.
std::optional<uint32_t> sizeForCharts(std::span<const LayoutChart> charts, double density, uint32_t most);

} // namespace relume
