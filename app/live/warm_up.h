#pragma once

#include <functional>

#include "bake/vk/device.h"

namespace relume {

/// Bakes and draws a level of one square, of which nothing is kept, so that a software device has compiled by
/// then what the first light of a real level takes. It ends early where `wanted` says that the device is.
/// Throws Error.
void warmUp(const vk::Device& device, const std::function<bool()>& wanted);

} // namespace relume
