#pragma once

#include "bake/vk/device.h"

namespace relume {

/// Returns the one device of this test process, with validation and synchronization validation:
/// RELUME_TEST_DEVICE names it (index or part of the name), else it is the best one. A test during which
/// validation says anything fails.
const vk::Device& testDevice();

} // namespace relume
