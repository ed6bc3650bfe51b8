#include "assets/images/finite_image.h"

#include "assets/base/error.h"

#include <spdlog/fmt/fmt.h>

#include <bit>
#include <cmath>
#include <cstdint>

namespace relume {
namespace {

// A look at the exponents alone, without an end before the last one, is what compilers do many at a time.
bool allFinite(const std::vector<float>& numbers) {
    constexpr uint32_t kExponent = 0x7f800000u; // all set: infinite or no number
    uint32_t bad = 0;
    for (const float number : numbers)
        bad |= (std::bit_cast<uint32_t>(number) & kExponent) == kExponent ? 1u : 0u;
    return bad == 0;
}

} // namespace

void requireFinite(const FloatImage& image, const std::string& name) {
    for (size_t c = 0; c < image.planes.size(); ++c) {
        if (allFinite(image.planes[c])) continue;
        for (size_t i = 0; i < image.planes[c].size(); ++i)
            if (!std::isfinite(image.planes[c][i]))
                throw Error(
                    fmt::format("{}: channel {} of texel {},{} is not a finite number: lower what shines, "
                                "or its weight",
                                name, image.channels[c], i % image.width, i / image.width));
    }
}

} // namespace relume
