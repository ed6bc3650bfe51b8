#include "app/bench/light_difference.h"

#include "assets/base/error.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace relume {

LightDifference compareLight(const PatchSet& patches, const PatchLight& light, const PatchLight& reference,
                             const glm::vec3& scale) {
    ASSERT(light.size() >= patches.count && reference.size() >= patches.count);
    double squared = 0, most = 0, sum = 0;
    uint64_t count = 0;
    for (size_t i = 0; i < patches.count; ++i) {
        const uint32_t flags = patches.scene.patches[i].flags;
        if (!shader::patchIsShown(flags)) continue;
        for (int k = 0; k < 3; ++k) {
            const double off = double{scale[k]} * light[i][k] - reference[i][k];
            squared += off * off;
            most = std::max(most, std::abs(off));
            sum += reference[i][k];
        }
        count += 3;
    }
    if (most == 0) return {};
    if (sum <= 0) return {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
    const double mean = sum / static_cast<double>(count);
    return {std::sqrt(squared / static_cast<double>(count)) / mean, most / mean};
}

} // namespace relume
