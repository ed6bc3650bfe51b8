#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "assets/model/lightmap_pages.h"

namespace relume {

/// Returns how many texels along a page's edges stay empty, so that no filter reads another page where the
/// pages lie side by side: none where there is one page.
constexpr uint32_t borderOf(const LightmapPages& pages) {
    return pages.count > 1 ? 1 : 0;
}

/// Deals objects to pages so that these are filled alike: the largest first, each to the page with the least
/// area so far. Returns the page of each object, which depends on areas and their order alone. `already`
/// holds what each page has before, or nothing.
std::vector<uint32_t> dealToPages(std::span<const double> areas, uint32_t pages,
                                  std::span<const double> already = {});

} // namespace relume
