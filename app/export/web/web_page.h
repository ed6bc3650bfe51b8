#pragma once

#include <optional>
#include <string>
#include <vector>

#include "assets/atlas/world_mesh.h"
#include "assets/images/layered_exr.h"
#include "assets/model/scene.h"

namespace relume {

/// Says which page is written, and where.
struct WebDesc {
    std::string path;                   // a folder, which is made where it is missing, or one file (.html)
    bool single = false;                // one file holds all
    std::optional<float> exposure = {}; // [EV]; none: what the first picture asks for
    std::vector<std::string> frames;    // pictures of a time lapse, by path
};

/// Returns the pictures of a folder that `relume timelapse` wrote, in order. Throws Error where there are
/// none.
std::vector<std::string> framesIn(const std::string& folder);

/// Returns the paths of the files that writeWebPage() writes.
std::vector<std::string> webFiles(const WebDesc& desc);

/// Throws Error where they cannot be written: call before long work.
void checkWebPage(const WebDesc& desc);

/// Writes a page with the mix board of a scene's lights: the scene lit by its layers, in WebGL 2. It opens
/// from a disk and asks nothing from a network. Errors name the file of the layers `name`. Files of the same
/// names are replaced, each whole or not at all. Throws Error.
void writeWebPage(const WebDesc& desc, const Scene& scene, const WorldMesh& mesh, const LayeredImage& image,
                  const std::string& name);

} // namespace relume
