#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "assets/model/scene.h"

namespace relume {

/// Says what of a file is read where it offers a choice.
struct GltfChoice {
    std::string scene = {};          // name or number of a scene; "": the file's default
    std::string variant = {};        // of KHR_materials_variants; "": the file's own materials
    std::optional<double> time = {}; // of the first animation [s]; none: the rest pose
    bool operator==(const GltfChoice&) const = default;
};

/// Reads a .gltf or .glb file. What it cannot use goes to Scene::warnings. Throws Error naming the file, the
/// thing and the remedy; where a chosen name is none of the file's, it lists those that are.
Scene loadGltf(const std::string& path, const GltfChoice& choice = {});

/// Writes a scene as one binary .glb: meshes shared by instances, one node per instance (or one for all
/// where Mesh::batched asks for it and there are eight or more), materials, textures
/// (PNG), cameras, lights (KHR_lights_punctual; extents, area lights and the sky as extras, see README.md),
/// emission above 1 by KHR_materials_emissive_strength. The sky's picture stays where Sky::file is; one
/// without a file is written beside the .glb as NAME_sky.exr. The file is written by a temporary name and
/// then renamed. Loading the result gives the same scene. Throws Error.
void saveGlb(const Scene& scene, const std::string& path);

/// Says what a file has for programs that show lightmaps.
struct GlbLook {
    std::vector<int> lightmaps; // of each page, indices into Scene::textures, or empty; told by MOZ_lightmap,
                                // in TEXCOORD_1
    float intensity = 1.0f;     // what a 1 of its texels stands for [cd/m^2]
    std::vector<bool> lit;      // by Scene::materials: those that it lights
    std::vector<uint32_t> page; // by Scene::materials: which page does; empty: there is one
    std::vector<int> maps;      // textures in the lightmap's layout, which mipmaps would smear across charts
    bool matte = false; // no highlights (KHR_materials_specular), which would take from the diffuse light
};

/// Returns the bytes that saveGlb() writes for a scene whose sky has no picture. `pictures`, where it is not
/// empty, has for each image of the scene its file (PNG or JPEG), which is taken as it is, or nothing: such
/// an image is encoded as PNG. Throws Error.
std::vector<uint8_t> glbBytes(const Scene& scene, std::span<const std::vector<uint8_t>> pictures = {},
                              const GlbLook& look = {});

/// Throws the Error of saveGlb() where the scene is such that it is sure to fail. Changes nothing.
void checkGlb(const Scene& scene, const std::string& path);

} // namespace relume
