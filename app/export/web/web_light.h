#pragma once

#include <map>
#include <string>
#include <vector>

#include "app/export/web/web_container.h"
#include "assets/images/layered_exr.h"
#include "bake/lights/light_source.h"

namespace relume {

/// Finds the layer of a scene's light.
class LightLayers {
public:
    LightLayers(const Scene& scene, const LayeredImage& image);
    /// Returns the layer's number, or -1 where the light has none.
    int of(const LightKey& key) const;

private:
    std::map<LightKey, int> numbers_;
};

/// Adds the light of each layer as it is at a weight of 1, in 32 bits per texel with a shared exponent, and
/// with it the weight, intensity and colour that the layer has. Throws Error, naming the file of the layers
/// `name`, where it is no square or holds values that are not finite.
void addLight(WebContainer& to, const LayeredImage& image, const std::string& name);

/// Adds the pictures of a time lapse by their paths, in order. Of many it takes 48, evenly spread, the last
/// one included. They become WebP with little loss. Throws Error.
void addFrames(WebContainer& to, const std::vector<std::string>& paths);

/// Returns which of `count` things are taken where there is room for `most` (at least 2): all of them, or so
/// many, evenly spread with both ends.
std::vector<size_t> evenlySpread(size_t count, size_t most);

} // namespace relume
