#pragma once

#include <cstdint>

namespace relume {

/// A number that no other call in this process gave or gives, above 0: tells whether what was drawn before is
/// still the same.
uint64_t newVersion();

} // namespace relume
