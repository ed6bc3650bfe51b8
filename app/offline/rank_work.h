#pragma once

#include <functional>
#include <string>

#include "app/offline/bake_options.h"
#include "bake/ranks/launch.h"
#include "bake/ranks/ranks.h"

namespace relume {

/// Does `work` on the ranks that a launcher started, or in this process alone, where nothing of MPI is begun.
/// An error on one rank ends the work on all: the first one that failed says why, and the others, whose
/// log is off from then on, throw, too. Throws UsageError where the program was built without MPI.
void runOnRanks(const Launch& launch, const std::function<void(Ranks&)>& work);

/// Throws UsageError where several processes cannot share the bake that is asked for by these options.
void checkSharedBake(const BakeOptions& options, const BakeRequest& request, uint32_t ranks);

/// Throws Error on all ranks where one says something else than rank 0, such as another device: bytes would
/// depend on who bakes what. `what` is one line.
void requireAlike(Ranks& ranks, const std::string& what);

} // namespace relume
