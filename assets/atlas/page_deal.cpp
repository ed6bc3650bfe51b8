#include "assets/atlas/page_deal.h"

#include <algorithm>
#include <numeric>

namespace relume {

std::vector<uint32_t> dealToPages(std::span<const double> areas, uint32_t pages,
                                  std::span<const double> already) {
    std::vector<double> load(pages, 0.0);
    std::copy(already.begin(), already.end(), load.begin());
    std::vector<uint32_t> order(areas.size()), dealt(areas.size(), 0);
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return areas[a] > areas[b]; });
    for (const uint32_t object : order) {
        const auto least = std::min_element(load.begin(), load.end());
        dealt[object] = static_cast<uint32_t>(least - load.begin());
        *least += areas[object];
    }
    return dealt;
}

} // namespace relume
