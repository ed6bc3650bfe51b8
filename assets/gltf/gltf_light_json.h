#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "assets/model/scene.h"

// Lights and sky as glTF files hold them (see README.md), for whatever writes such files.
namespace relume::gltf {

/// A glm vector's numbers.
template<class Vector>
nlohmann::ordered_json jsonArray(const Vector& v) {
    auto out = nlohmann::ordered_json::array();
    for (int i = 0; i < v.length(); ++i)
        out.push_back(v[i]);
    return out;
}

/// Whether KHR_lights_punctual has no word for it, so that it goes into its node's extras.
bool isAreaLight(LightType type);

/// An entry of the list of KHR_lights_punctual.
nlohmann::ordered_json punctualLightJson(const Light& light);

/// The member extras.relume.areaLight of a node.
nlohmann::ordered_json areaLightJson(const Light& light);

/// The member extras.relume.sky of a scene. file: of the picture, from the folder of the glTF file, "" for
/// none.
nlohmann::ordered_json skyJson(const Sky& sky, const std::string& file);

} // namespace relume::gltf
