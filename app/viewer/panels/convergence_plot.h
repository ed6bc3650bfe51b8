#pragma once

#include <vector>

#include "app/live/live_bake.h"

namespace relume {

/// Draws the remaining error over seconds of solving, with the error on a logarithmic axis and a line at
/// `aim`; 0: no line. The local error, where it is told, is a paler curve with a line of its own.
void drawConvergencePlot(const std::vector<ConvergencePoint>& history, double aim, double localAim);

} // namespace relume
