#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>
#include <tiny_gltf.h>

#include "assets/base/warnings.h"
#include "assets/gltf/gltf.h"
#include "assets/gltf/gltf_size.h"
#include "assets/model/scene.h"

namespace relume::gltf {

class NodePlaces;

/// Holds what the builders share: the parsed file, already checked, and the scene made from it.
struct Build {
    std::string path;
    GltfChoice choice;
    tinygltf::Model model;            // without nodes, scenes and lights: the parser is slow for very many
    nlohmann::json nodes, scenes;     // arrays as in the file
    nlohmann::json lights;            // the array of KHR_lights_punctual as in the file
    nlohmann::json skins, animations; // arrays as in the file, whose entries are not checked
    std::map<size_t, int> bentMeshes; // by node: the scene's mesh where it is not that of the file's number
    int sceneNumber = 0;              // of the scene that is read
    std::set<size_t> skinnedNodes;    // whose meshes stand where their joints put them
    SizeLimit limit;
    Scene scene;
    Warnings warnings;
};

/// Reads all elements of an accessor as floats, `components` per element. Normalized integers become [0,1] or
/// [-1,1], and sparse parts are applied. The accessor must have exactly that many components.
std::vector<float> readFloats(const tinygltf::Model& model, const tinygltf::Accessor& accessor,
                              uint32_t components);

/// Reads a scalar accessor of unsigned integers.
std::vector<uint32_t> readIndices(const tinygltf::Model& model, const tinygltf::Accessor& accessor);

/// Fills Scene::images, textures and materials; images that nothing Relume knows uses are left out. Throws
/// Error for a missing or undecodable image.
void buildMaterials(Build& build);

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

/// Returns an image of the file as 8-bit RGBA and drops the parsed file's bytes of it. Throws Error where it
/// is missing, cannot be decoded or is too large; warns where it is damaged.
Image decodeImage(Build& build, int index);

/// Returns a numeric member of an extension's JSON, or `fallback` where it is missing.
double numberOr(const tinygltf::Value& value, const char* key, double fallback);

/// Is the image loader to hand to tinygltf: it keeps the file's bytes and decodes nothing.
bool keepImageBytes(tinygltf::Image* image, int index, std::string* error, std::string* warning, int width,
                    int height, const unsigned char* bytes, int size, void* user);

} // namespace relume::gltf
