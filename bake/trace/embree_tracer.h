#pragma once

#include <memory>

#include "bake/trace/tracer.h"

namespace relume {

/// Makes the tracer that runs on the CPU, by Embree.
std::unique_ptr<Tracer> makeEmbreeTracer(const TraceScene& scene);

} // namespace relume
