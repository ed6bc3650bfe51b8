#pragma once

#include <string>

#include "bake/baker/baker.h"

namespace relume {

/// Returns "name=value" pairs, separated by spaces, of all settings that change what a bake computes;
/// batches, caches and what becomes of the result are not among them. The lightmap's attribute
/// relume:settings and the key of checkpoints are made of it.
std::string describeSettings(const BakeSettings& settings);

} // namespace relume
