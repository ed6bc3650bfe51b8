#pragma once

#include <string>

#include "assets/gltf/gltf.h"

namespace CLI {
class App;
}

namespace relume {

/// Adds --scene, --variant and --time, which say what of a scene's file is read. Every verb that reads a
/// scene has them.
void addChoiceOptions(CLI::App& command, GltfChoice& choice);

/// Returns the choice as it is typed after a verb, with a blank in front; "" for the file's own defaults.
std::string typedChoice(const GltfChoice& choice);

} // namespace relume
