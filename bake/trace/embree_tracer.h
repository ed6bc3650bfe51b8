#pragma once

#include <memory>

#include "bake/trace/tracer.h"

namespace relume {

/// The tracer that runs on the CPU, by Embree.
std::unique_ptr<Tracer> makeEmbreeTracer(const TraceScene& scene);

} // namespace relume
