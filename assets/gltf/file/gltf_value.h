#pragma once

#include <string>

#include <nlohmann/json.hpp>

// These functions read the parts of a file that check() does not look at, above all extensions: whatever has
// a wrong type or range there counts as missing.
namespace relume::gltf {

constexpr const char* kPunctualLights = "KHR_lights_punctual";
constexpr const char* kAreaLights = "EXT_lights_area";
constexpr const char* kVisibility = "KHR_node_visibility";
constexpr const char* kSpecularGlossiness = "KHR_materials_pbrSpecularGlossiness";

/// Returns a member of `holder`, or nullptr where it is missing or `holder` is no object.
const nlohmann::json* memberOf(const nlohmann::json& holder, const char* key);

/// Returns the extension of this name, whatever its type is, or nullptr where `holder` has none.
const nlohmann::json* extensionOf(const nlohmann::json& holder, const char* name);

/// Tells whether a node is visible by itself (KHR_node_visibility); one below a node that is not is
/// invisible, too.
bool isVisible(const nlohmann::json& node);

/// Returns a number, a text, an index below `entries` (-1: none) and a boolean.
double numberOr(const nlohmann::json& holder, const char* key, double fallback);
std::string textOr(const nlohmann::json& holder, const char* key, const std::string& fallback);
int indexBelow(const nlohmann::json& holder, const char* key, size_t entries);
bool boolOr(const nlohmann::json& holder, const char* key, bool fallback);

} // namespace relume::gltf
