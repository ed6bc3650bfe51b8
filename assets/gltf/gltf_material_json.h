#pragma once

#include <map>
#include <span>
#include <string>

#include <nlohmann/json.hpp>

#include "assets/gltf/gltf.h"
#include "assets/model/scene.h"

namespace relume::gltf {

/// The extensions that a file uses, by name.
using UsedExtensions = std::map<std::string, bool>;

/// Returns a material as glTF has it, without what programs for lightmaps read; `kept` has the numbers of
/// kept textures in the file. Throws Error, naming the material, for a texture transform that glTF cannot
/// store.
nlohmann::ordered_json materialJson(const Material& material, std::span<const int> kept,
                                    UsedExtensions& used);

/// Adds to a material's JSON what `look` says of it.
void addLook(nlohmann::ordered_json& json, const GlbLook& look, size_t material, UsedExtensions& used);

/// Returns the sampler of a texture, with mipmaps or without.
nlohmann::ordered_json samplerJson(const Texture& texture, bool mipmaps);

} // namespace relume::gltf
