#pragma once

#include <string>

#include "assets/model/scene.h"

#include <glm/gtc/matrix_transform.hpp>

namespace relume {

/// Returns a light of this intensity, in its type's unit, that looks along -z.
inline Light lightAt(LightType type, glm::vec3 position, float intensity, const std::string& name) {
    Light light;
    light.name = name;
    light.type = type;
    light.transform = glm::translate(glm::mat4(1.0f), position);
    light.intensity = intensity;
    return light;
}

} // namespace relume
