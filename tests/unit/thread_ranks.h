#pragma once

#include <functional>

#include "bake/ranks/ranks.h"

namespace relume {

/// Runs `work` as so many ranks that are threads of this process, and waits for all of them. What one throws
/// ends the program.
void runThreadRanks(uint32_t count, const std::function<void(Ranks&)>& work);

} // namespace relume
