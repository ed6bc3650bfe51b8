#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "bake/baker/memory_needs.h"

namespace relume {

/// Returns the most bytes of the host's memory that a bake's surfaces take at a time: what the CIT pass
/// leaves, and the patches that are made of it, when every texel is covered. A device's own memory is not
/// counted, but so many bytes that it spills to the host once the patches are made.
uint64_t hostNeeds(const BakeSettings& settings, const SceneExtent& scene, uint64_t spilled = 0);

/// Returns the memory that programs may still take, by the text of /proc/meminfo [bytes]; nothing where it
/// does not say.
std::optional<uint64_t> availableIn(std::string_view memInfo);
/// Returns the same of this machine as it is now.
std::optional<uint64_t> freeHostMemory();

} // namespace relume
