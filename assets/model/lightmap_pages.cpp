#include "assets/model/lightmap_pages.h"

#include <cmath>

namespace relume {

uint32_t pagesForDensity(double area, double density, double coverage, uint32_t edge) {
    const double texels = area * density * density, each = coverage * edge * edge;
    if (!(texels > 0.0)) return 1;
    const double pages = std::ceil(texels / each);
    if (!(each > 0.0) || !(pages < double(kMostPages))) return kMostPages;
    return pages < 1.0 ? 1 : static_cast<uint32_t>(pages);
}

} // namespace relume
