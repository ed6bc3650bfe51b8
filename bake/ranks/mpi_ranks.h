#pragma once

#include <memory>

#include "bake/ranks/launch.h"
#include "bake/ranks/ranks.h"

namespace relume {

/// Tells whether the program was built with MPI.
bool hasMpi();

/// Begins MPI, once per process, and returns the ranks that the launcher started; they end MPI when they go.
/// Throws UsageError where the program was built without MPI, and Error where there are others than the
/// launcher said.
std::unique_ptr<Ranks> startMpi(const Launch& launch);

} // namespace relume
