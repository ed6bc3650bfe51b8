#pragma once

#include <string>
#include <vector>

#include "assets/model/scene.h"

namespace relume {

struct SceneName {
    std::string name;        // as typed by the user
    std::string description; // one line
};

/// The scenes the program can make, those in assets/scenes and "lamps", in the order to list them.
std::vector<SceneName> generatedSceneNames();

/// Makes a scene: real-world metres, TEXCOORD_1 of all instances together one lightmap atlas, at least one
/// camera. The same name gives the same scene to the last bit on every platform. Throws Error listing the
/// names when there is none of that name.
Scene generateScene(const std::string& name);

} // namespace relume
