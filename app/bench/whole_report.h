#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "assets/base/phase_clock.h"

namespace relume {

/// A whole bake, from the start of the process or of its reading to the written lightmap.
struct WholeBake {
    std::string tracer;
    uint32_t size = 0, patches = 0, triangles = 0;
    std::vector<PhaseTime> phases; // with "other", so that they sum up to the whole
};

/// Returns the sum of all parts, and of all but "solve".
PhaseTime wholeOf(const WholeBake& bake);
PhaseTime besideSolver(const WholeBake& bake);

/// Returns a table with a row per part and their sum: seconds by the clock, CPU seconds of all threads,
/// share.
std::string wholeTable(const WholeBake& bake);
nlohmann::ordered_json wholeJson(const WholeBake& bake);

} // namespace relume
