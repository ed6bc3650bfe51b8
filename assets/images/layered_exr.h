#pragma once

#include <map>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "assets/images/float_image.h"

namespace relume {

/// Attributes of layers that say more about their lights; any may be missing.
namespace layer_attribute {
constexpr const char* kType = "relume:type"; // "point", ..., "emitter", "sky", "group"
constexpr const char* kUnit = "relume:unit"; // of the intensity
// These two hold the light as its scene has it, in that unit and linear, as texts ("40", "1,0.5,0.2"): what
// `weight` was made of, also where that is 0 because the light is off. Where they are missing, the intensity
// is the weight's brightest channel, and the colour is weight / intensity.
constexpr const char* kIntensity = "relume:intensity";
constexpr const char* kColor = "relume:color";
constexpr const char* kStale = "relume:stale"; // why the layer does not show the scene any more, one line
// This one is of a group: the names of its lights, one per line (app/offline/name_lines.h).
constexpr const char* kMembers = "relume:members";
} // namespace layer_attribute

/// Holds a lightmap light by light: composite = sum of weight x layer.
struct LayeredImage {
    struct Layer {
        std::string name;                              // unlike that of any other layer
        glm::vec3 weight{1.0f};                        // of R, G and B
        std::map<std::string, std::string> attributes; // see layer_attribute
        FloatImage image;                              // R, G and B; as large as the composite
    };
    FloatImage composite; // R, G and B, and what else there is of the sum: coverage
    std::vector<Layer> layers;
};

/// Writes an OpenEXR file of several parts: the composite, which readers of one image take, then one part per
/// layer, named as the layer is, with the attributes relume:name and relume:weight. It is written
/// by a temporary name, as writeImage does. Equal images give equal bytes. Throws Error.
void writeLayeredExr(const std::string& path, const LayeredImage& image, ExrType type = ExrType::Float,
                     ExrCompression compression = kExrCompression);

/// Returns the bytes that writeLayeredExr writes. Throws Error.
std::string encodeLayeredExr(const std::string& path, const LayeredImage& image,
                             ExrType type = ExrType::Float, ExrCompression compression = kExrCompression);

/// Rounds the layers' pixels to what a file of this type holds; warns, naming `path`, where they are cut.
void roundLayers(const std::string& path, LayeredImage& image, ExrType type);

/// Reads a file that writeLayeredExr wrote. Throws Error where it has no layers, parts are missing or differ
/// in size, a channel or a weight is missing or a weight is not finite.
LayeredImage readLayeredExr(const std::string& path);

} // namespace relume
