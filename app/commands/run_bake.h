#pragma once

#include "app/bench/whole_report.h"
#include "app/offline/bake_options.h"

namespace relume {

/// Does all that `relume bake` does and returns how long each part took. startSeconds is what had passed of
/// this process before [s], 0: not of interest. These ranks share the bake: all of them call it, and the
/// first one writes files and returns what it measured. Throws Error and UsageError.
WholeBake runBake(BakeOptions options, double startSeconds, Ranks& ranks = oneProcess());

} // namespace relume
