#pragma once

#include <cstdint>

#include <glm/glm.hpp>

#include "assets/images/float_image.h"
#include "renderer/gl/texture.h"
#include "renderer/version.h"

namespace relume {

/// Describes a lightmap to draw with, whoever made and owns the texture. RGB holds lighting (irradiance / pi)
/// or, for the views that inspect, another quantity; A holds coverage (1 a patch, 0.5 filled from its
/// neighbours, 0 empty); row 0 is v = 0. Empty texels are 0 in all channels; the texture filters linearly and
/// clamps at its edges.
struct LightmapTexture {
    GLuint texture = 0;      // 0: no light yet, all is lit by `ambient`
    uint32_t size = 0;       // edge [texels]
    glm::vec3 ambient{1.0f}; // lighting of what has no lightmap UVs [cd/m^2]
    float unit = 1.0f;       // lighting of a texel's 1 [cd/m^2]
    bool filled = false;  // within two texels of a patch none is empty: filters need not look and are faster
    uint64_t version = 0; // another one for other texels (newVersion); 0: they may have changed, always draw

    bool operator==(const LightmapTexture&) const = default;
};

/// Texels whose coverage is above it are patches; below it they are filled or empty.
constexpr float kCoveredTexel = 0.75f;

/// Returns the channels of one texel as they are in the texture, without `unit`. Waits for the device.
glm::vec4 readTexel(const LightmapTexture& lightmap, glm::uvec2 texel);

/// Owns a lightmap texture that is made from an image: it has 16-bit floats where they hold its values, else
/// 32-bit ones.
class LightmapImage {
public:
    /// Takes channels R, G, B and perhaps coverage, without which all texels count as covered. Throws Error,
    /// naming the image `name`, where it is not square or a channel is missing.
    LightmapImage(const FloatImage& image, const std::string& name);

    LightmapTexture texture() const {
        return {.texture = texture_.get(),
                .size = texture_.width(),
                .ambient = ambient_,
                .unit = 1.0f,
                .filled = filled_,
                .version = version_};
    }

private:
    uint64_t version_ = newVersion();
    gl::Texture texture_;
    bool filled_ = false;
    glm::vec3 ambient_{0.0f}; // mean of the patches
};

} // namespace relume
