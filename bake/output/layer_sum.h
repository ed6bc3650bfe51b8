#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "assets/base/worker_pool.h"
#include "assets/images/float_image.h"

namespace relume {

/// Sums layers up, one at a time: each weight times layer in double precision, rounded once at the end. So
/// the sum depends on the layers and their order alone, and on no device.
class LayerSum {
public:
    /// `pool` must outlive it.
    LayerSum(WorkerPool& pool, uint32_t width, uint32_t height);
    /// Adds a layer of this size, which has R, G and B. Where a weight is 0 it is off, whatever it holds.
    void add(const glm::vec3& weight, const FloatImage& layer);
    /// Makes R, G and B of the composite, which has them, the sum.
    void writeTo(FloatImage& composite) const;

private:
    WorkerPool& pool_;
    std::array<std::vector<double>, 3> totals_; // R, G, B of each texel
};

} // namespace relume
