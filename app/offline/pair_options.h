#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "bake/solver/solver.h"

namespace CLI {
class App;
}

namespace relume {

/// Tells whether the method takes windows of texels together.
bool hasWindow(Method method);

/// The options that the user typed for the pair methods and the caches.
struct PairOptions {
    std::optional<uint32_t> window, node; // [texels]
    std::optional<double> threshold, thresholdRamp;
    std::string cache = "auto", cacheMemory;
};

void addPairOptions(CLI::App& command, PairOptions& options);

/// Throws UsageError for values that are wrong or that the method has no use for.
void resolvePairOptions(const PairOptions& options, SolverSettings& settings);

/// Returns name and value of those that the method uses, as "name=value" with a blank before each.
std::string describePairSettings(const SolverSettings& settings);

} // namespace relume
