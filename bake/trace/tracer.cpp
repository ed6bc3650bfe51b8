#include "bake/trace/tracer.h"

#include "assets/base/error.h"

namespace relume {

void Tracer::update(const SceneChange&) {
    ASSERT(follows());
}

void Tracer::updateSenders(std::span<const uint32_t>) {}

void Tracer::retrace(VkCommandBuffer, const RetraceWork&) {
    ASSERT(follows());
}

} // namespace relume
