#pragma once

#include "assets/model/scene.h"

namespace relume {

/// Returns "point", "spot", ...
inline const char* lightTypeName(LightType type) {
    switch (type) {
    case LightType::Point:
        return "point";
    case LightType::Spot:
        return "spot";
    case LightType::Directional:
        return "directional";
    case LightType::Rectangle:
        return "rectangle";
    case LightType::Disc:
        return "disc";
    }
    return "";
}

/// Returns the unit of Light::intensity.
inline const char* lightUnit(LightType type) {
    if (type == LightType::Directional) return "lux";
    return type == LightType::Point || type == LightType::Spot ? "cd" : "cd/m^2";
}

} // namespace relume
