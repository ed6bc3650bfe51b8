#pragma once

#include <vector>

#include "app/live/live_bake.h"

namespace relume {

/// Remaining error over seconds of solving, the error on a logarithmic axis; aim: a line, 0: none.
void drawConvergencePlot(const std::vector<ConvergencePoint>& history, double aim);

} // namespace relume
