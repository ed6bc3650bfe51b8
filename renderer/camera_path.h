#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "renderer/camera.h"

namespace relume {

/// Returns `count` (> 1) cameras on a smooth way through all stops, in equal steps of time with as long for
/// each leg. The first and the last of them are the first and the last stop. The eye goes along a Catmull-Rom
/// spline [Catmull, Rom 1974]; the direction turns by a spline of quaternions (squad, [Shoemake 1987]). Where
/// one stop is a perspective and the next one is orthographic, that changes half way. stops.size() > 1.
std::vector<ViewCamera> cameraPath(std::span<const ViewCamera> stops, uint32_t count);

} // namespace relume
