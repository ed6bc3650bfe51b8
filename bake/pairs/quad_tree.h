#pragma once

#include "bake/pairs/sender_list.h"

namespace relume {

struct QuadTreeDesc {
    uint32_t node = 8; // edge of the largest node [texels], a power of two
    float threshold = 0.05f;
    bool rtrad = false; // RTRad's nodes, absolute threshold and first texels instead of means
};

/// Returns the senders of adaptive subdivision: leaves of quad-trees over what the patches send (thesis: over
/// ligIn). Four nodes merge when 0.5 |mean(light) - light_0| + 0.5 |mean(normal) - normal_0| < threshold, 0
/// being the first of them, light relative to its mean over all patches. Nodes hold texels of one chart and
/// side; dark leaves are left out. `parts` comes from mergeableParts, `radiance` is that of each patch. In
/// the preset weights are RTRad's a.
SenderList quadTreeSenders(const PatchSet& patches, const std::vector<uint32_t>& parts,
                           const std::vector<glm::vec4>& radiance, const QuadTreeDesc& desc);

} // namespace relume
