#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "assets/gltf/file/gltf_check_json.h"
#include "assets/gltf/file/gltf_value.h"

namespace relume::gltf {

// These check the extensions that meshes are read by, and throw Error as JsonChecks does.

/// Throws Error where something that vertices are read from uses a required extension that is unknown.
void checkRequired(const JsonChecks& checks);
/// Tells whether an extension is one that Relume reads.
bool isKnownExtension(const std::string& name);
/// Checks EXT_meshopt_compression of a buffer view.
void checkCompressedView(const JsonChecks& checks, const nlohmann::json& view, const std::string& where);
/// Checks KHR_draco_mesh_compression of a primitive.
void checkDraco(const JsonChecks& checks, const nlohmann::json& primitive, const std::string& where);
/// Checks the morph targets of a primitive.
void checkTargets(const JsonChecks& checks, const nlohmann::json& primitive, const std::string& where);
/// Checks EXT_mesh_gpu_instancing of a node.
void checkInstancing(const JsonChecks& checks, const nlohmann::json& node, const std::string& where);

/// Tells whether a buffer has no bytes of its own, as its views hold compressed ones that lie elsewhere.
bool isPlaceholder(const nlohmann::json& buffer);

constexpr const char* kDraco = "KHR_draco_mesh_compression";
constexpr const char* kMeshopt = "EXT_meshopt_compression";
constexpr const char* kInstancing = "EXT_mesh_gpu_instancing";

} // namespace relume::gltf
