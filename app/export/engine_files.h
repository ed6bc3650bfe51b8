#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include <glm/glm.hpp>

namespace relume {

/// Who shows an exported level.
enum class Engine { Any, Three, Babylon, PlayCanvas, Bevy, Godot, Unity, Blender };

/// Returns the engines' names by number, as users type them: "any", "three", ...
const std::vector<std::string>& engineNames();
/// Throws Error for a name that is none of these.
Engine engineOf(const std::string& name);

/// A file of text, by its name in the exported folder.
struct EngineFile {
    std::string name, text;
};

/// A material that the lightmap lights.
struct LitMaterial {
    std::string name;
    uint32_t page = 0; // of the lightmap
};

/// What the files tell of the level.
struct EngineFacts {
    std::string name;      // of the level
    float exposure = 0.0f; // [EV]: light counts 2^exposure times on a screen
    glm::vec3 sky{0.0f};   // what is seen behind it [cd/m^2]
    uint32_t pages = 1;    // of its lightmap
    std::vector<LitMaterial> lit = {};
};

/// Tells whether an engine's files load a lightmap of several pages; else they are one texture.
bool knowsPages(Engine engine);

/// Returns the files that an engine needs beside the level and its lightmap, README.txt among them.
std::vector<EngineFile> engineFiles(Engine engine, const EngineFacts& facts);

} // namespace relume
