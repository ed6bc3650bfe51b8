#include "bake/output/layer_sum.h"

#include "assets/base/error.h"
#include "assets/base/portions.h"

#include <algorithm>
#include <string>

namespace relume {

namespace {

constexpr size_t kTexelsAtATime = size_t{1} << 16; // of a plane, by a thread

} // namespace

LayerSum::LayerSum(WorkerPool& pool, uint32_t width, uint32_t height) : pool_(pool) {
    totals_.fill(std::vector<double>(size_t{width} * height));
}

void LayerSum::add(const glm::vec3& weight, const FloatImage& layer) {
    for (int c = 0; c < 3; ++c) {
        const double factor = weight[c];
        if (factor == 0.0) continue;
        std::vector<double>& total = totals_[static_cast<size_t>(c)];
        const std::vector<float>* plane = layer.find(std::string(1, "RGB"[c]));
        ASSERT(plane && plane->size() == total.size());
        runPortions(pool_, total.size(), kTexelsAtATime, [&](size_t begin, size_t end) {
            for (size_t i = begin; i < end; ++i)
                total[i] += factor * (*plane)[i];
        });
    }
}

void LayerSum::writeTo(FloatImage& composite) const {
    for (size_t c = 0; c < 3; ++c) {
        const auto at =
            std::find(composite.channels.begin(), composite.channels.end(), std::string(1, "RGB"[c]));
        ASSERT(at != composite.channels.end());
        std::vector<float>& plane = composite.planes[static_cast<size_t>(at - composite.channels.begin())];
        ASSERT(plane.size() == totals_[c].size());
        runPortions(pool_, plane.size(), kTexelsAtATime, [&](size_t begin, size_t end) {
            for (size_t i = begin; i < end; ++i)
                plane[i] = static_cast<float>(totals_[c][i]);
        });
    }
}

} // namespace relume
