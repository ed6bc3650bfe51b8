#pragma once

#include "app/edit/prepare.h"
#include "app/offline/bake_settings.h"

#include <string>

namespace relume {

constexpr uint32_t kQuickSize = 64;
// Tests wait so long [s]: the bake gets what time the machine has left, and under a sanitizer a tenth of
// that.
constexpr double kPatience = 240;

inline BakeSettings quickSettings() {
    BakeSettings settings;
    settings.size = kQuickSize;
    settings.solver.method = Method::Hybrid;
    settings.solver.error = 0.02;
    return settings;
}

inline PreparedScene cornell() {
    return prepareScene(
        {.path = std::string(RELUME_SOURCE_DIR) + "/assets/scenes/cornell_small.glb", .size = kQuickSize});
}

} // namespace relume
