#pragma once

#include "bake/vk/device.h"

namespace relume::vk {

/// Loads the driver's compiled pipelines of earlier runs from $XDG_CACHE_HOME/relume (else ~/.cache/relume),
/// one file per device and driver version. Never fails: without a file the cache starts empty, at worst it is
/// VK_NULL_HANDLE.
VkPipelineCache loadPipelineCache(VkDevice device, const DeviceInfo& info);
/// Writes the cache back under a temporary name and renames it. Failures are ignored: a cache only saves
/// time.
void savePipelineCache(VkDevice device, const DeviceInfo& info, VkPipelineCache cache) noexcept;

} // namespace relume::vk
