#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "assets/model/scene.h"

namespace relume {

/// Says what many kinds of files do not tell themselves.
struct ForeignChoice {
    double scale = 1; // factor on all lengths, beside the unit that the file tells
    char up = 'y'; // axis that points up in what is read, 'x', 'y' or 'z'; where the file or its kind tells
                   // of another one than Y, that is Y already
};

/// A file of another kind, converted.
struct ForeignScene {
    Scene scene;
    /// For each of Scene::images its file (PNG or JPEG), where it was taken as it is; such an image has no
    /// pixels in Scene::images.
    std::vector<std::vector<uint8_t>> pictures;
};

/// Hears how far a conversion is, from 0 to 1.
using ForeignProgress = std::function<void(float done)>;

/// Reads a file by libassimp and makes a scene of it, as README.md says. Files that it names are looked for
/// by NearFiles. What cannot be used goes to Scene::warnings. Throws Error; a damaged file may also crash
/// this process or take its memory, for which there is importForeign().
ForeignScene convertForeign(const std::string& path, const ForeignChoice& choice = {},
                            const ForeignProgress& progress = nullptr);

} // namespace relume
