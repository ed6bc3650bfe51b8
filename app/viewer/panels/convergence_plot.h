#pragma once

#include <vector>

#include "app/live/live_bake.h"

namespace relume {

/// Draws the remaining error over seconds of solving, with the error on a logarithmic axis and a line at
/// `aim`; 0: no line.
void drawConvergencePlot(const std::vector<ConvergencePoint>& history, double aim);

} // namespace relume
