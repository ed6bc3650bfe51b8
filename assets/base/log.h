#pragma once

#include <spdlog/spdlog.h>

namespace relume {

/// Sends spdlog's messages to stderr, one per line, the level shown only from warning up. Call once, in main.
void setupLog(bool quiet);

} // namespace relume
