#pragma once

#include <spdlog/spdlog.h>

namespace relume {

/// Sends spdlog's messages to stderr, one per line; the level is shown only from warning up. Call it once, in
/// main.
void setupLog(bool quiet);

} // namespace relume
