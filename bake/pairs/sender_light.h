#pragma once

#include "bake/pairs/pair_passes.h"
#include "bake/pairs/sender_list.h"

namespace relume {

/// Returns what each patch sends [cd/m^2] at this light, as radiance.comp has it: emission + reflectivity *
/// albedo * light; in the RTRad preset its light itself.
std::vector<glm::vec4> patchRadiance(const PatchSet& patches, const std::vector<glm::vec4>& light,
                                     const TransportSettings& transport);

/// Tells how a sender's light follows from its members'.
enum class SenderLight {
    First,     // that of the first member; RTRad: times the weight
    Mean,      // by area
    RtradTree, // RTRad's quad-tree: ligIn.a holds the weight
    RtradMips, // RTRad's mip maps of ligIn, looked up in the middle of a window
};

/// Returns what each sender sends. radiance is that of all patches; window is the edge [texels], for
/// RtradMips.
std::vector<glm::vec4> senderRadiance(const PatchSet& patches, const SenderList& list,
                                      const std::vector<glm::vec4>& radiance, SenderLight kind,
                                      uint32_t window);

} // namespace relume
