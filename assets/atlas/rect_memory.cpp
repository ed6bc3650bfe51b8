#include "assets/atlas/rect_memory.h"

#include "assets/atlas/unwrap_memory.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

namespace relume {
namespace {

// An object keeps its rectangle while it wants at most so many times more or less texels along an edge, and
// while the proportions of both differ by no more than this.
constexpr double kMostChange = 2.0, kMostSkew = 1.25;
constexpr size_t kMostNew = 32; // objects: with more, the file has become another one

uint64_t texelsOf(const PackedRect& rect) {
    return uint64_t{rect.width} * rect.height;
}

bool suits(const PackedRect& rect, const WantedRect& wanted) {
    if (rect.width == wanted.width && rect.height == wanted.height) return true;
    const double x = double(wanted.width) / rect.width, y = double(wanted.height) / rect.height;
    return std::max(x, y) <= kMostChange && std::min(x, y) >= 1.0 / kMostChange &&
           std::max(x / y, y / x) <= kMostSkew;
}

// The texels of a page that no rectangle has, nor its gutter.
class FreeTexels {
public:
    FreeTexels(uint32_t edge, uint32_t gutter) : edge_(edge), gutter_(gutter), taken_(size_t{edge} * edge) {}

    uint64_t count() const { return free_; }

    void take(const PackedRect& rect) {
        const auto before = [&](uint32_t at) { return at - std::min(at, gutter_); };
        for (uint32_t y = before(rect.y); y < std::min(rect.y + rect.height + gutter_, edge_); ++y)
            for (uint32_t x = before(rect.x); x < std::min(rect.x + rect.width + gutter_, edge_); ++x)
                free_ -= std::exchange(taken_[size_t{y} * edge_ + x], uint8_t{1}) == 0 ? 1 : 0;
    }

    /// Finds the lowest place, and there the leftmost.
    bool find(PackedRect& rect) const {
        if (rect.width > edge_ || rect.height > edge_) return false;
        std::vector<uint32_t> height(edge_, 0); // of the free column that ends in this row
        for (uint32_t y = 0; y < edge_; ++y) {
            uint32_t run = 0; // of columns that are high enough
            for (uint32_t x = 0; x < edge_; ++x) {
                height[x] = taken_[size_t{y} * edge_ + x] == 0 ? height[x] + 1 : 0;
                run = height[x] >= rect.height ? run + 1 : 0;
                if (run < rect.width) continue;
                rect.x = x + 1 - rect.width;
                rect.y = y + 1 - rect.height;
                return true;
            }
        }
        return false;
    }

private:
    uint32_t edge_, gutter_;
    std::vector<uint8_t> taken_;
    uint64_t free_ = uint64_t{edge_} * edge_;
};

// Finds the remembered object of each one wanted: those of a name in their order.
std::vector<const RectMemory::Object*> matched(const RectMemory& memory, std::span<const WantedRect> wanted) {
    std::map<std::string, std::vector<const RectMemory::Object*>> named; // the last first
    for (auto object = memory.objects.rbegin(); object != memory.objects.rend(); ++object)
        named[object->name].push_back(&*object);
    std::vector<const RectMemory::Object*> found(wanted.size(), nullptr);
    for (size_t i = 0; i < wanted.size(); ++i) {
        const auto entry = named.find(wanted[i].name);
        if (entry == named.end() || entry->second.empty()) continue;
        found[i] = entry->second.back();
        entry->second.pop_back();
    }
    return found;
}

uint32_t scaled(uint32_t texels, double share) {
    return std::max(1u, static_cast<uint32_t>(std::lround(texels * share)));
}

// Finds a place on the emptiest page that has one, at the largest share that fits; 0 where none does.
double fitIn(RectMemory::Object& object, const WantedRect& wanted, std::vector<FreeTexels>& pages) {
    std::vector<uint32_t> order(pages.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(),
                     [&](uint32_t a, uint32_t b) { return pages[a].count() > pages[b].count(); });
    for (const double share : kShares)
        for (const uint32_t page : order) {
            object.page = page;
            object.rect = {.width = scaled(wanted.width, share), .height = scaled(wanted.height, share)};
            if (!pages[page].find(object.rect)) continue;
            pages[page].take(object.rect);
            return share;
        }
    return 0.0;
}

} // namespace

std::optional<RememberedRects> placeAgain(const RectMemory& memory, std::span<const WantedRect> wanted,
                                          uint32_t edge, uint32_t gutter) {
    const std::vector<const RectMemory::Object*> before = matched(memory, wanted);
    RememberedRects result;
    std::vector<FreeTexels> pages(memory.pages, FreeTexels(edge, gutter));
    std::vector<size_t> without;
    const auto note = [&](double share) {
        result.coarser += share < 1.0 ? 1 : 0;
        result.leastShare = std::min(result.leastShare, share);
    };
    for (size_t i = 0; i < wanted.size(); ++i) {
        result.objects.push_back({wanted[i].name, 0, {}});
        if (!before[i] || !suits(before[i]->rect, wanted[i])) {
            without.push_back(i);
            continue;
        }
        result.objects[i] = *before[i];
        pages[before[i]->page].take(before[i]->rect);
        note(std::min(double(before[i]->rect.width) / wanted[i].width,
                      double(before[i]->rect.height) / wanted[i].height));
    }
    if (without.size() > kMostNew) return std::nullopt;
    // The largest are the hardest to place.
    std::stable_sort(without.begin(), without.end(), [&](size_t a, size_t b) {
        return uint64_t{wanted[a].width} * wanted[a].height > uint64_t{wanted[b].width} * wanted[b].height;
    });
    for (const size_t i : without) {
        const double share = fitIn(result.objects[i], wanted[i], pages);
        if (share == 0.0) return std::nullopt;
        note(share);
    }
    uint64_t used = 0, usedBefore = 0;
    for (const RectMemory::Object& object : result.objects)
        used += texelsOf(object.rect);
    for (const RectMemory::Object& object : memory.objects)
        usedBefore += texelsOf(object.rect);
    if (static_cast<double>(used) < kStillUsed * static_cast<double>(usedBefore)) return std::nullopt;
    return result;
}

} // namespace relume
