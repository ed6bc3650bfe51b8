#pragma once

#include <cstdint>
#include <functional>
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

} // namespace relume
