#pragma once

#include <string>
#include <vector>

#include "assets/model/scene.h"

namespace relume {

struct SceneName {
    std::string name;        // as typed by the user
    std::string description; // one line
    bool hasLightmapUvs = true;
};

/// Returns the scenes that the program can make, those in assets/scenes and "lamps", in the order to list
/// them.
std::vector<SceneName> generatedSceneNames();

/// Makes a scene in real-world metres. All but "raw" have a camera and light. Where the list says so,
/// TEXCOORD_1 of all instances together is one lightmap atlas; the others have none. The same name gives the
/// same scene to the last bit on every platform. Throws Error listing the names where there is none of that
/// name.
Scene generateScene(const std::string& name);

} // namespace relume
