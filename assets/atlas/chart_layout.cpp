#include "assets/atlas/chart_layout.h"

#include "assets/atlas/mask_atlas.h"
#include "assets/base/error.h"
#include "assets/base/watch.h"
#include "assets/model/lightmap_pages.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>
#include <numeric>

namespace relume {

namespace {

constexpr double kThin = 0.5;  // [texels]; a side below it needs no gutter: see layOutCharts
constexpr double kReach = 0.5; // [texels], how far bilinear filters reach beyond a texel's edge
constexpr double kThinnest =
    0.125; // [texels]; below it float UVs of a large atlas could not tell corners apart
// A chart narrower than this ends on the centres of texels, where filters read no texel beyond: it needs no
// gutter, and is a texel longer in place of two. Wider ones gain less than patches that lie on their surface
// as a whole.
constexpr double kCentred = 16.0; // [texels]
// So far beyond the centre it ends, which rasterizers that count 1/256 texels find inside, and filters that
// do give what lies beyond no weight that is more. [texels]
constexpr double kBeyond = 1.0 / 256.0;
constexpr double kNeedle = 8.0;       // [texels]; a chart no wider may be shortened to the atlas' length
constexpr double kShortened = 1.15;   // times the atlas' length: any chart up to it may be shortened to that
constexpr uint32_t kMostCells = 2048; // to a side: packing time grows with the fourth power of it
constexpr uint32_t kSmall = 3;        // [texels]; charts of no longer box are turned by a quarter at most
constexpr double kFullBox = 0.97;     // share of a box; above it a half turn changes nothing that matters

// A search starts here: charts with their gutters fill some 80 % of an atlas, and the next densities are this
// step apart until one fits and one does not.
constexpr double kStartFill = 0.8, kStep = 1.02;
constexpr double kExact = 1.0015;  // ratio of densities that ends the search
constexpr int kMostHalvings = 200; // of the density until each chart has but one texel
constexpr uint32_t kTall = 2;      // heights of the atlas in which the first guesses are packed
constexpr int kGuesses = 3;
// Work is counted in charts of all trials together; its bounds keep the search within some 0.5 s on 2 cores.
constexpr size_t kSearchWork = 60000;
constexpr int kFewTrials = 3, kManyTrials = 8;

// So many charts of a trial are looked for a place for again, from the bottom on: each look costs some 0.1
// ms.
constexpr uint32_t kSecondLooks = 1000;

// Walls of one length may fit three to a row at 0.99 of a density and two at the whole: texels that are 4 %
// wider than high change the stretch by 0.0004, and may cover 3 % more.
constexpr std::array kAspects = {1.0, 0.98, 1.0 / 0.98};

enum class Order { Perimeter, Area, Longest };
constexpr std::array kOrders = {Order::Perimeter, Order::Area, Order::Longest};

/// Holds what a trial packs with.
struct Trial {
    double density = 1.0; // [cells/m]
    double aspect = 1.0;
    Order order = Order::Perimeter;
    uint32_t size = 1, height = 1; // of the atlas [cells]
};

/// Holds a chart's fitted box in one of the two ways in which its axes may lie in the atlas.
struct Fitted {
    ChartPlace place; // without corner and turns
    TexelMask mask;   // gutter included
    uint64_t touched = 0;
    bool full = false; // the chart fills its box
};

/// Returns the chart as it lies with its first axis along the atlas' rows, or its second one; nothing where
/// it is too long.
std::optional<ChartPlace> fit(const LayoutChart& chart, const Trial& trial, bool turned) {
    const double wide = trial.density * chart.scale * trial.aspect;
    const double high = trial.density * chart.scale / trial.aspect;
    const glm::dvec2 density = turned ? glm::dvec2(high, wide) : glm::dvec2(wide, high);
    const glm::dvec2 texels = chart.chart->extent * density;
    const bool needle = std::min(texels.x, texels.y) <= kNeedle;
    const bool centred = std::min(texels.x, texels.y) < kCentred;
    ChartPlace place;
    for (int c = 0; c < 2; ++c) {
        const double extent = std::max(chart.chart->extent[c], 1e-300);
        if (!(texels[c] <= kShortened * trial.size) && !needle) return std::nullopt;
        const double whole = std::clamp(std::round(texels[c]), 1.0, double(trial.size));
        const bool toCentres = centred && texels[c] >= kThin && whole < double(trial.size);
        const double side = toCentres         ? whole + 2.0 * kBeyond
                            : texels[c] < 1.0 ? std::max(texels[c], kThinnest)
                                              : whole;
        const double box = toCentres ? whole + 1.0 : whole;
        place.box[c] = static_cast<uint32_t>(box);
        place.inset[c] = 0.5 * (box - std::min(side, box));
        place.stretch[c] = side / extent;
    }
    return place;
}

std::optional<Fitted> fitMask(const LayoutChart& chart, const Trial& trial, bool turned) {
    const std::optional<ChartPlace> place = fit(chart, trial, turned);
    if (!place) return std::nullopt;
    Fitted fitted{*place, {}, 0, false};
    const glm::dvec2 sides = chart.chart->extent * place->stretch;
    const glm::dvec2 growth(sides.x < kThin ? 0.0 : kReach, sides.y < kThin ? 0.0 : kReach);
    TexelMask touched(place->box.x, place->box.y);
    fitted.mask = TexelMask(place->box.x + 2, place->box.y + 2);
    const std::vector<glm::dvec2>& uv = chart.chart->uv;
    for (size_t i = 0; i + 2 < uv.size(); i += 3) {
        const glm::dvec2 a = place->texelOf(uv[i]), b = place->texelOf(uv[i + 1]),
                         c = place->texelOf(uv[i + 2]);
        touched.addTouched(a, b, c);
        fitted.mask.addGrown(a + 1.0, b + 1.0, c + 1.0, growth);
    }
    fitted.touched = touched.count();
    fitted.full = static_cast<double>(fitted.touched) > kFullBox * place->box.x * place->box.y;
    return fitted;
}

/// Counts the charts that would be longer than the atlas, and tells what share of its length one keeps at the
/// least.
void countShortened(std::span<const LayoutChart> charts, const Trial& trial, ChartLayout& layout) {
    layout.shortened = 0;
    layout.leastShare = 1.0;
    for (size_t i = 0; i < charts.size(); ++i) {
        const ChartPlace& place = layout.places[i];
        double share = 1.0;
        for (int c = 0; c < 2; ++c) {
            // The axis lies along the atlas' rows or columns, whose texels may be wider than high.
            const bool row = (c == 0) == (place.turns % 2 == 0);
            const double aspect = row ? trial.aspect : 1.0 / trial.aspect;
            const double wanted = charts[i].chart->extent[c] * trial.density * charts[i].scale * aspect;
            if (std::round(wanted) > double(trial.size)) share = std::min(share, trial.size / wanted);
        }
        layout.shortened += share < 1.0 ? 1 : 0;
        layout.leastShare = std::min(layout.leastShare, share);
    }
}

/// Places charts one after the other, each as low as it can lie. Where charts of about the same size found
/// nothing lower, none is looked for again.
class Packer {
public:
    Packer(std::span<const LayoutChart> charts, const Trial& trial)
        : charts_(charts), trial_(trial), atlas_(trial.size + 2, trial.height + 2) {
        layout_.density = trial.density;
        layout_.aspect = trial.aspect;
        layout_.places.resize(charts.size());
    }
    bool take(size_t chart, const ChartPlace& place);
    bool pack(size_t chart);
    bool packAll();
    uint32_t rows() const { return rows_; } // that charts reach into
    ChartLayout& layout() { return layout_; }

private:
    struct Found {
        glm::uvec2 place;
        uint32_t turns = 0, top = 0;
    };
    bool packFrom(size_t chart, bool bottom);
    void add(size_t chart, const Fitted& fitted, const MaskShape& shape, glm::uvec2 place, uint32_t turns);
    uint32_t& lowest(const MaskShape& shape, uint32_t turns, bool full);

    std::span<const LayoutChart> charts_;
    Trial trial_;
    MaskAtlas atlas_; // with a rim of one texel, into which gutters may reach
    ChartLayout layout_;
    uint32_t rows_ = 0;
    uint32_t secondLooks_ = 0;
    std::map<std::array<uint32_t, 3>, uint32_t> lowest_; // by size, turns
};

uint32_t sizeClass(uint32_t texels) {
    constexpr double kClasses = 4.0; // to a factor of two
    return static_cast<uint32_t>(std::log2(double(texels)) * kClasses);
}

uint32_t& Packer::lowest(const MaskShape& shape, uint32_t turns, bool full) {
    return lowest_[{sizeClass(shape.width), sizeClass(shape.height), full ? 4 : turns}];
}

void Packer::add(size_t chart, const Fitted& fitted, const MaskShape& shape, glm::uvec2 place,
                 uint32_t turns) {
    atlas_.add(shape, place);
    ChartPlace& result = layout_.places[chart];
    result = fitted.place;
    result.corner = place; // the rim and the mask's gutter are one texel each
    result.turns = turns;
    layout_.touched += fitted.touched;
    layout_.reserved += fitted.mask.count();
    rows_ = std::max(rows_, place.y + shape.height - 2);
}

TexelMask turnedBy(TexelMask mask, uint32_t turns) {
    for (uint32_t i = 0; i < turns; ++i)
        mask = mask.turned();
    return mask;
}

/// Puts a chart where it was before, if that is as large as it would be now, and free.
bool Packer::take(size_t chart, const ChartPlace& place) {
    const std::optional<Fitted> fitted = fitMask(charts_[chart], trial_, place.turns % 2 == 1);
    if (!fitted) return false;
    const MaskShape shape(turnedBy(fitted->mask, place.turns));
    if (fitted->place.box != place.box || !atlas_.isFree(shape, place.corner)) return false;
    add(chart, *fitted, shape, place.corner, place.turns);
    return true;
}

bool Packer::pack(size_t chart) {
    if (packFrom(chart, false)) return true;
    // Charts of its size found nothing lower, but this one may be a little smaller.
    if (secondLooks_ == kSecondLooks) return false;
    ++secondLooks_;
    return packFrom(chart, true);
}

bool Packer::packFrom(size_t chart, bool bottom) {
    std::array<std::optional<Fitted>, 2> fitted;
    std::optional<Found> found;
    std::optional<MaskShape> best;
    for (uint32_t turns = 0; turns < 4; ++turns) {
        std::optional<Fitted>& own = fitted[turns % 2];
        if (turns == 1 && trial_.aspect == 1.0)
            own = fitted[0];
        else if (turns < 2)
            own = fitMask(charts_[chart], trial_, turns == 1);
        if (!own) return false;
        // A half turn of a full box changes nothing, and that of a small one too little.
        if (turns >= 2 && (own->full || std::max(own->place.box.x, own->place.box.y) <= kSmall)) break;
        MaskShape shape(turnedBy(own->mask, turns));
        if (shape.width > atlas_.width() || shape.height > atlas_.height()) continue;
        if (found && found->top <= shape.height) continue;
        const uint32_t last = found ? found->top - shape.height - 1 : atlas_.height() - shape.height;
        uint32_t& from = lowest(shape, turns, own->full);
        if (bottom) from = 0;
        if (last < from) continue;
        const std::optional<glm::uvec2> place = atlas_.lowestPlace(shape, from, last);
        from = place ? place->y : last + 1;
        if (!place) continue;
        found = Found{*place, turns, place->y + shape.height};
        best = std::move(shape);
    }
    if (!found) return false;
    add(chart, *fitted[found->turns % 2], *best, found->place, found->turns);
    return true;
}

/// Returns the charts, the largest first.
std::vector<uint32_t> sorted(std::span<const LayoutChart> charts, const Trial& trial) {
    std::vector<double> keys(charts.size());
    for (size_t i = 0; i < charts.size(); ++i) {
        const std::optional<ChartPlace> place = fit(charts[i], trial, false);
        const glm::dvec2 box = place ? glm::dvec2(place->box) + 2.0 : glm::dvec2(trial.size);
        const double longest = std::max(box.x, box.y), shortest = std::min(box.x, box.y);
        keys[i] = trial.order == Order::Area      ? box.x * box.y
                  : trial.order == Order::Longest ? longest + 0.1 * shortest
                                                  : longest + shortest;
    }
    std::vector<uint32_t> order(charts.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return keys[a] > keys[b]; });
    return order;
}

bool Packer::packAll() {
    const std::vector<uint32_t> order = sorted(charts_, trial_);
    return std::all_of(order.begin(), order.end(), [this](uint32_t chart) { return pack(chart); });
}

/// Looks for the highest density at which all charts fit.
class Search {
public:
    Search(std::span<const LayoutChart> charts, uint32_t size, double most, WorkerPool& pool)
        : charts_(charts), size_(size), most_(most), pool_(pool) {}
    /// Returns nothing where the charts do not even fit with one texel for each.
    std::optional<ChartLayout> run();
    /// Tells whether they do.
    bool fitsAtAll() const {
        return tryAt(std::ldexp(guess(), -kMostHalvings), 1.0, Order::Perimeter).has_value();
    }

private:
    double guess() const;
    std::optional<ChartLayout> tryAt(double density, double aspect, Order order) const;
    std::optional<ChartLayout> climb(double start, double aspect, Order order, int trials) const;
    std::optional<ChartLayout> anyThatFits(double start) const;

    std::span<const LayoutChart> charts_;
    uint32_t size_;
    double most_; // [cells/m], nothing above it is wanted
    WorkerPool& pool_;
};

std::optional<ChartLayout> Search::tryAt(double density, double aspect, Order order) const {
    Packer packer(charts_, {density, aspect, order, size_, size_});
    if (!packer.packAll()) return std::nullopt;
    return std::move(packer.layout());
}

/// Returns a density at which the charts need about the whole atlas.
double Search::guess() const {
    double area = 0.0;
    for (const LayoutChart& chart : charts_)
        area += areaOf(chart);
    double density = std::sqrt(kStartFill / area) * size_;
    if (!(area > 0.0) || !std::isfinite(density)) density = 1.0;
    density = std::min(density, most_);
    for (int i = 0; i < kGuesses; ++i) {
        tellWatch("packing charts", 0.25 * i / kGuesses);
        Packer packer(charts_, {density, 1.0, Order::Perimeter, size_, kTall * size_});
        const bool fits = packer.packAll();
        const double need = fits ? double(packer.rows()) / size_ : double(kTall);
        if (fits && need <= 1.0 && density >= most_) return most_;
        density = std::min(most_, density / std::sqrt(std::max(need, 0.05)));
    }
    return density;
}

/// Goes up from a start in steps while the charts fit, and down while they do not, then halves what is
/// between.
std::optional<ChartLayout> Search::climb(double start, double aspect, Order order, int trials) const {
    std::optional<ChartLayout> best;
    double density = start, low = 0.0, high = 0.0, step = kStep;
    for (int i = 0; i < trials && (high == 0.0 || low == 0.0 || high / low > kExact); ++i) {
        std::optional<ChartLayout> layout = tryAt(density, aspect, order);
        if (layout) {
            low = density;
            best = std::move(layout);
            if (density >= most_) break;
        } else {
            high = density;
        }
        density = low == 0.0    ? high / step
                  : high == 0.0 ? std::min(low * step, most_)
                                : std::sqrt(low * high);
        step *= step;
    }
    return best;
}

/// Lowers the density until the charts fit, at the least to one texel for each.
std::optional<ChartLayout> Search::anyThatFits(double start) const {
    for (int i = 0; i < kMostHalvings; ++i, start *= 0.5) {
        tellWatch("packing charts");
        if (!tryAt(start, 1.0, Order::Perimeter)) continue;
        return climb(start, 1.0, Order::Perimeter, kManyTrials);
    }
    return std::nullopt;
}

std::optional<ChartLayout> Search::run() {
    const double start = guess();
    const size_t each = std::max<size_t>(charts_.size() * std::max(1u, size_ / 1024), 1);
    const auto affordable = static_cast<int>(std::min<size_t>(kSearchWork / each, 1000));
    struct Way {
        double aspect;
        Order order;
    };
    std::vector<Way> ways;
    for (double aspect : kAspects)
        for (Order order : kOrders)
            ways.push_back({aspect, order});
    const auto few = static_cast<size_t>(std::max(affordable / kManyTrials, 1));
    if (ways.size() > few) ways.resize(few);
    const int trials = std::clamp(affordable, kFewTrials, kManyTrials);
    std::vector<std::optional<ChartLayout>> layouts(ways.size());
    pool_.run(static_cast<uint32_t>(ways.size()), [&](uint32_t i) {
        tellWatch("packing charts", 0.25 + 0.75 * i / static_cast<double>(ways.size()));
        layouts[i] = climb(start, ways[i].aspect, ways[i].order, trials);
    });
    std::optional<ChartLayout> best;
    for (std::optional<ChartLayout>& layout : layouts) {
        // Texels that are not square must gain enough to be worth it.
        constexpr double kWorth = 1.01;
        const double worth = best && best->aspect == 1.0 && layout && layout->aspect != 1.0 ? kWorth : 1.0;
        if (layout && (!best || layout->density > worth * best->density)) best = std::move(layout);
    }
    return best ? std::move(best) : anyThatFits(start);
}

uint32_t texelsPerCell(uint32_t size) {
    return (size + kMostCells - 1) / kMostCells;
}

// Throws an Error that names a size which fits.
[[noreturn]] void throwTooMany(std::span<const LayoutChart> charts, uint32_t size, WorkerPool& pool) {
    std::string mend = "no size does: merge meshes or leave some out";
    for (uint32_t larger = std::bit_ceil(size + 1); larger <= kMaxPageSize; larger *= 2) {
        const uint32_t cells = larger / texelsPerCell(larger);
        if (charts.size() > size_t{cells} * cells) continue;
        if (!Search(charts, cells, HUGE_VAL, pool).fitsAtAll()) continue;
        mend = fmt::format("--size {} fits", larger);
        break;
    }
    throw Error(fmt::format("{} charts do not fit a lightmap of {} x {} texels: {}", charts.size(), size,
                            size, mend));
}

} // namespace

double areaOf(const LayoutChart& chart) {
    double area = 0.0;
    const std::vector<glm::dvec2>& uv = chart.chart->uv;
    for (size_t i = 0; i + 2 < uv.size(); i += 3) {
        const glm::dvec2 a = uv[i + 1] - uv[i], b = uv[i + 2] - uv[i];
        area += 0.5 * std::abs(a.x * b.y - a.y * b.x);
    }
    return area * chart.scale * chart.scale;
}

glm::dvec2 ChartPlace::texelOf(glm::dvec2 uv) const {
    glm::dvec2 p = glm::clamp(inset + uv * stretch, glm::dvec2(0.0), glm::dvec2(box));
    glm::dvec2 extent(box);
    for (uint32_t i = 0; i < turns; ++i) {
        p = {extent.y - p.y, p.x};
        std::swap(extent.x, extent.y);
    }
    return glm::dvec2(corner) + p;
}

ChartLayout layOutCharts(std::span<const LayoutChart> charts, const LayoutDesc& desc, WorkerPool& pool) {
    ASSERT(desc.size > 0);
    const uint32_t texel = texelsPerCell(desc.size), cells = desc.size / texel;
    if (charts.size() > size_t(cells) * cells) throwTooMany(charts, desc.size, pool);
    ChartLayout layout;
    const double most = desc.density > 0.0 ? desc.density / texel : HUGE_VAL;
    if (!charts.empty()) {
        std::optional<ChartLayout> found = Search(charts, cells, most, pool).run();
        if (!found) throwTooMany(charts, desc.size, pool);
        layout = std::move(*found);
    }
    countShortened(charts, {layout.density, layout.aspect, Order::Perimeter, cells, cells}, layout);
    layout.density *= texel;
    layout.texel = texel;
    return layout;
}

bool isAsBefore(const LayoutChart& chart, const ChartLayout& layout, uint32_t size, const ChartPlace& place) {
    const uint32_t cells = size / layout.texel;
    const Trial trial{layout.density / layout.texel, layout.aspect, Order::Perimeter, cells, cells};
    const std::optional<ChartPlace> now = fit(chart, trial, place.turns % 2 == 1);
    return now && now->box == place.box;
}

std::optional<ChartLayout> extendLayout(std::span<const LayoutChart> charts, const LayoutDesc& desc,
                                        const ChartLayout& layout,
                                        std::span<const std::optional<ChartPlace>> places) {
    ASSERT(places.size() == charts.size());
    const uint32_t cells = desc.size / layout.texel;
    const Trial trial{layout.density / layout.texel, layout.aspect, Order::Perimeter, cells, cells};
    Packer packer(charts, trial);
    for (size_t i = 0; i < charts.size(); ++i)
        if (places[i] && !packer.take(i, *places[i])) return std::nullopt;
    for (uint32_t i : sorted(charts, trial))
        if (!places[i] && !packer.pack(i)) return std::nullopt;
    ChartLayout result = std::move(packer.layout());
    countShortened(charts, trial, result);
    result.density = layout.density;
    result.texel = layout.texel;
    return result;
}

std::optional<uint32_t> sizeForCharts(std::span<const LayoutChart> charts, double density, uint32_t most) {
    double area = 0.0, longest = 0.0;
    for (const LayoutChart& chart : charts) {
        area += areaOf(chart);
        longest =
            std::max({longest, chart.scale * chart.chart->extent.x, chart.scale * chart.chart->extent.y});
    }
    // Neither the area nor the longest chart may need more than the atlas has.
    double size =
        std::max({std::sqrt(area) * density, longest * density, std::sqrt(double(charts.size())), 1.0});
    constexpr double kGrow = 1.04;
    for (; size <= most; size = std::max(size * kGrow, size + 1.0)) {
        const auto texels = static_cast<uint32_t>(std::ceil(size));
        const uint32_t texel = texelsPerCell(texels), cells = texels / texel;
        tellWatch("packing charts");
        Packer packer(charts, {density / texel, 1.0, Order::Perimeter, cells, cells});
        if (packer.packAll()) return texels;
    }
    return std::nullopt;
}

} // namespace relume
