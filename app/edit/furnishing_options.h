#pragma once

#include "app/edit/prepare.h"

namespace CLI {
class App;
}

namespace relume {

/// Adds --no-unwrap, --density, --no-daylight and --strict: what a level gets that its file lacks.
void addFurnishingOptions(CLI::App& command, Furnishing& furnishing);
/// Throws UsageError where they contradict each other.
void checkFurnishing(const Furnishing& furnishing);

} // namespace relume
