#pragma once

#include <cstdint>

namespace relume {

/// Returns a number above 0 that no other call in this process gave or gives; it tells whether what was drawn
/// before is still the same.
uint64_t newVersion();

} // namespace relume
