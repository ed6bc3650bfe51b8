#pragma once

#include <cstdint>

#include <glm/glm.hpp>

#include "assets/float_image.h"
#include "renderer/gl/texture.h"

namespace relume {

/// A lightmap to draw with, whoever made and owns the texture: lighting (irradiance / pi) in RGB, coverage in
/// A (1 a patch, 0.5 filled from its neighbours, 0 empty), row 0 is v = 0.
struct LightmapTexture {
    GLuint texture = 0;      // 0: no light yet, all is lit by `ambient`
    uint32_t size = 0;       // edge [texels]
    glm::vec3 ambient{1.0f}; // lighting of what has no lightmap UVs [cd/m^2]
};

/// One that is made from an image: 16-bit floats where they hold its values, else 32-bit ones.
class LightmapImage {
public:
    /// Channels R, G, B and perhaps coverage: without it all texels count as covered. Throws Error, naming it
    /// `name`, when it is not square or a channel is missing.
    LightmapImage(const FloatImage& image, const std::string& name);

    LightmapTexture texture() const { return {texture_.get(), texture_.width(), ambient_}; }

private:
    gl::Texture texture_;
    glm::vec3 ambient_{0.0f}; // mean of the patches
};

} // namespace relume
