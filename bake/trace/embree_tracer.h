#pragma once

#include <memory>

#include "assets/base/worker_pool.h"
#include "bake/trace/tracer.h"

namespace relume {

/// Makes the tracer that runs on the CPU, by Embree and on the threads of a pool that outlives it.
std::unique_ptr<Tracer> makeEmbreeTracer(const TraceScene& scene, WorkerPool& pool);

} // namespace relume
