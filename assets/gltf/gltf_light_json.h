#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "assets/model/scene.h"

// This makes lights and sky as glTF files hold them (see README.md), for whatever writes such files.
namespace relume::gltf {

/// Returns a glm vector's numbers.
template<class Vector>
nlohmann::ordered_json jsonArray(const Vector& v) {
    auto out = nlohmann::ordered_json::array();
    for (int i = 0; i < v.length(); ++i)
        out.push_back(v[i]);
    return out;
}

/// Tells whether KHR_lights_punctual has no word for a light, so that it goes into its node's extras.
bool isAreaLight(LightType type);

/// Returns an entry of the list of KHR_lights_punctual.
nlohmann::ordered_json punctualLightJson(const Light& light);

/// Returns the member extras.relume.areaLight of a node.
nlohmann::ordered_json areaLightJson(const Light& light);

/// Returns an entry of the list of EXT_lights_area, for a node without scale.
nlohmann::ordered_json areaExtensionJson(const Light& light);

/// Returns the member extras.relume.sky of a scene. `file` is the path of the picture from the folder of the
/// glTF file, "" for none.
nlohmann::ordered_json skyJson(const Sky& sky, const std::string& file);

} // namespace relume::gltf
