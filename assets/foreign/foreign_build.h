#pragma once

#include <map>
#include <string>
#include <vector>

#include <assimp/scene.h>
#include <glm/glm.hpp>

#include "assets/base/warnings.h"
#include "assets/foreign/foreign_types.h"
#include "assets/foreign/near_files.h"

namespace relume::foreign {

/// Holds what the builders share: what libassimp read, and the scene made from it.
struct Build {
    explicit Build(const std::string& file) : path(file), near(file) {}

    std::string path;     // as given by the user
    std::string ending;   // in lower case, ".obj"
    bool inWatts = false; // lights and what glows have Blender's units
    const aiScene* source = nullptr;
    ForeignChoice choice;
    NearFiles near;
    std::vector<int> materials; // of the scene, by that of the file; -1: no mesh has it
    ForeignScene made;
    Warnings warnings;
};

/// Returns a name from the file as UTF-8: libassimp hands on the bytes of old files as they are, which are
/// taken for Latin-1.
std::string nameOf(const aiString& name);

/// This is the luminous efficacy of green light of 555 nm, by which the add-on and Blender's own glTF
/// exporter convert, too.
inline constexpr float kLumensPerWatt = 683.0f;

/// Returns by how much radiance in the file's unit becomes cd/m^2: Blender has watts, other files none.
inline float unitOfLight(const Build& build) {
    return build.inWatts ? kLumensPerWatt : 1.0f;
}

/// Returns what turns and scales what libassimp read into metres with Y up.
glm::dmat4 toMetres(const Build& build);

inline glm::vec3 vec3Of(const aiVector3D& v) {
    return {v.x, v.y, v.z};
}

/// Fills Scene::images, textures and materials, one per material that a mesh of the file has.
void buildMaterials(Build& build);

/// Makes a mesh of one or more meshes of the file, a primitive each. It is empty where no triangle is usable.
Mesh makeMesh(Build& build, const std::vector<unsigned>& meshes, const std::string& name);

/// Fills Scene::meshes and instances from the nodes, and the lights and cameras that stand in them.
void buildNodes(Build& build);

/// Tells where a light or a camera stands, and in which units.
struct Placing {
    glm::dmat4 world{1.0}; // of the node
    double scale = 1;      // metres per unit of the file
    float reach = 1;       // where a light without a unit shines as its file says [m]
};
void addCamera(Build& build, const aiCamera& camera, const Placing& placing);
void addLight(Build& build, const aiLight& light, const Placing& placing);

} // namespace relume::foreign
