#pragma once

#include <string>
#include <vector>

#include "app/offline/bake_options.h"

namespace relume {

/// A finished bake, for the figures of what it was and what it cost.
struct BakeStatistics {
    const BakeOptions& options;
    const PreparedScene& prepared;
    Baker& baker;
    const vk::DeviceInfo& device;
    const std::vector<PhaseTime>& phases;
    double bakeCpuSeconds; // of all threads, from the lightmap's rasterization to the finished map
};

/// Writes them as JSON to `path`, under a temporary name that is then changed, or to standard output for "-".
/// Throws Error.
void writeStatistics(const std::string& path, const BakeStatistics& statistics);

} // namespace relume
