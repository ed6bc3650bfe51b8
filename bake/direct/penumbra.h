#pragma once

#include "bake/vk/buffer.h"

namespace relume {

/// The places where neighbours see a light unalike (shaders/lib/light/penumbra.glsl), on the device.
struct Penumbra {
    vk::Buffer parts;  // uint per patch: TileParts::ofPatch
    vk::Buffer lights; // uvec2 per part; of the light under way
};

/// Returns what shaders find penumbrae in, or the notes of patches; 0 for neither.
inline VkDeviceAddress penumbraOf(const Penumbra* penumbra, const vk::Buffer* notes) {
    return penumbra ? penumbra->lights.address() : notes ? notes->address() : 0;
}

} // namespace relume
