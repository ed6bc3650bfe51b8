#pragma once

#include <string>
#include <vector>

namespace relume {

/// A scene that ships with the program.
struct ShippedScene {
    std::string name, path;
    std::string picture; // its small picture, a PNG that may be missing
    bool operator==(const ShippedScene&) const = default;
};

/// Returns the folder of the scenes that ship, "": there is none. They are in share/relume/scenes beside the
/// program's folder, as it is installed, else in assets/scenes of a folder above it, the source tree that it
/// was built in, or of `source`, the tree that the build named.
std::string shippedFolder(const std::string& program, const std::string& source);

/// Returns the path of this program; "": unknown.
std::string programPath();

/// Returns the scenes of a folder by name. Their pictures are beside them, as they are installed, or in
/// pictures/scenes beside the folder, as in the source tree.
std::vector<ShippedScene> shippedScenes(const std::string& folder);

} // namespace relume
