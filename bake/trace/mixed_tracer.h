#pragma once

#include <memory>

#include "bake/trace/tracer.h"

namespace relume {

/// Makes a tracer of two that answer one question: `exact` answers all of it, then `voxels`, made with a
/// ratio n above 1, replaces its share: the bits of senders whose texel (row * size + column) is a multiple
/// of n, every n-th group of 8 samples of the links and every n-th target of segments. Rays are counted once.
std::unique_ptr<Tracer> makeMixedTracer(const vk::Device& device, std::unique_ptr<Tracer> exact,
                                        std::unique_ptr<Tracer> voxels);

} // namespace relume
