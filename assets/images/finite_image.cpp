#include "assets/images/finite_image.h"

#include "assets/base/error.h"

#include <spdlog/fmt/fmt.h>

#include <cmath>

namespace relume {

void requireFinite(const FloatImage& image, const std::string& name) {
    for (size_t c = 0; c < image.planes.size(); ++c)
        for (size_t i = 0; i < image.planes[c].size(); ++i)
            if (!std::isfinite(image.planes[c][i]))
                throw Error(
                    fmt::format("{}: channel {} of texel {},{} is not a finite number: lower what shines, "
                                "or its weight",
                                name, image.channels[c], i % image.width, i / image.width));
}

} // namespace relume
