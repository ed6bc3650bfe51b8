#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>
#include <tiny_gltf.h>

#include "assets/base/warnings.h"
#include "assets/gltf/gltf.h"
#include "assets/gltf/file/gltf_size.h"
#include "assets/model/scene.h"

namespace relume::gltf {

class NodePlaces;
struct File;

/// Holds what the builders share: the parsed file, already checked, and the scene made from it.
struct Build {
    std::string path;
    GltfChoice choice;
    tinygltf::Model model;        // without what stands below: the parser is slow for very many nodes
    nlohmann::json nodes, scenes; // arrays as in the file
    nlohmann::json materials, textures, samplers, images; // likewise
    nlohmann::json lights;                                // the array of KHR_lights_punctual as in the file
    nlohmann::json areaLights;        // that of EXT_lights_area, whose entries are not checked
    nlohmann::json skins, animations; // arrays as in the file, whose entries are not checked
    std::map<size_t, int> bentMeshes; // by node: the scene's mesh where it is not that of the file's number
    std::set<size_t> skinnedNodes;    // whose meshes stand where their joints put them
    int sceneNumber = 0;              // of the scene that is read
    int variant = -1;                 // of Scene::variantNames, -1: the file's own materials
    SizeLimit limit;
    Scene scene;
    Warnings warnings;
};

/// Fills the model of a build from a checked file, and the arrays that stand beside it. Throws Error.
void parse(File file, Build& build);

/// Reads all elements of an accessor as floats, `components` per element. Normalized integers become [0,1] or
/// [-1,1], and sparse parts are applied. The accessor must have exactly that many components.
std::vector<float> readFloats(const tinygltf::Model& model, const tinygltf::Accessor& accessor,
                              uint32_t components);

/// Reads a scalar accessor of unsigned integers, to which sparse parts are applied. Throws Error, without the
/// file's name, where one of these names an element that there is not, as readFloats() does.
std::vector<uint32_t> readIndices(const tinygltf::Model& model, const tinygltf::Accessor& accessor);

/// Fills Scene::images, textures and materials. Images that nothing Relume knows uses are not even read; one
/// that is missing or cannot be decoded leaves its texture out, with a warning. Throws Error where the images
/// have too many pixels.
void buildMaterials(Build& build);

/// Fills Scene::variantNames from the file's JSON and finds the variant that is chosen. Throws Error, which
/// lists the variants, where there is none of that name.
void chooseVariant(Build& build, const nlohmann::json& root);

/// Returns the material of a primitive: that of the chosen variant where it has one, else its own; -1 for
/// glTF's default material.
int materialOf(const Build& build, const tinygltf::Primitive& primitive);

/// Marks the materials that light passes, once all else is built, and warns about materials that blend.
void markPanes(Build& build);

/// Fills Scene::meshes, one per mesh of the file (empty where nothing of it is usable), and one for each node
/// whose skin or morph targets give it a shape of its own. Throws Error.
void buildMeshes(Build& build, NodePlaces& places);

/// Fills Scene::instances, cameras and lights from the nodes of the scene that is read, or all root nodes
/// where there is no scene. Walks without recursion. Throws Error.
void buildNodes(Build& build, NodePlaces& places);

/// Adds the lights of a node to Scene::lights: that of KHR_lights_punctual, and an area light of its extras.
void addLights(Build& build, size_t node, const glm::mat4& world);

/// Fills Scene::sky from that scene's extras, its picture included. Throws Error.
void buildSky(Build& build);

/// Returns an image of the file (PNG, JPEG or WebP) as 8-bit RGBA. Returns nothing, and warns, where it is
/// missing or cannot be decoded; warns where it is damaged. Throws Error where it is too large.
std::optional<Image> decodeImage(Build& build, size_t index);

/// Returns the bytes of an image that the file holds or names; nothing, and in `problem` what is wrong with
/// it, where there are none.
std::vector<unsigned char> imageBytes(const Build& build, const nlohmann::json& source, std::string& problem);

} // namespace relume::gltf
