#include "renderer/lightmap_texture.h"

#include "assets/base/error.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace relume {
namespace {

struct Range {
    glm::dvec3 sum{0.0}; // of covered texels
    double count = 0;
    float largest = 0; // of all
};

// Tells whether half floats hold the light. They are fine to 2^-11 of their value from 6e-5 to 65504;
// brighter maps, and those whose mean is so dark that shadows would be steps, take floats.
bool fitsHalf(const Range& range) {
    const double mean = (range.sum.x + range.sum.y + range.sum.z) / std::max(3.0 * range.count, 1.0);
    return range.largest < 6e4f && mean > 1e-2;
}

// Tells whether no texel that a filter reaches from a patch is empty.
bool isFilled(const std::vector<glm::vec4>& texels, int64_t size) {
    constexpr int64_t kReach = 2; // [texels], of the cubic filter
    // This goes along rows, then along columns of the patches so widened.
    std::vector<uint8_t> wide(texels.size(), 0);
    for (int64_t i = 0; i < size * size; ++i) {
        if (texels[static_cast<size_t>(i)].a < kCoveredTexel) continue;
        const int64_t row = i - i % size, first = std::max(i - kReach, row);
        const int64_t last = std::min(i + kReach, row + size - 1);
        std::fill(wide.begin() + first, wide.begin() + last + 1, uint8_t{1});
    }
    for (int64_t i = 0; i < size * size; ++i) {
        if (wide[static_cast<size_t>(i)] == 0) continue;
        for (int64_t k = std::max(i - kReach * size, i % size);
             k <= std::min(i + kReach * size, size * size - 1); k += size)
            if (texels[static_cast<size_t>(k)].a <= 0.0f) return false;
    }
    return true;
}

} // namespace

glm::vec4 readTexel(const LightmapTexture& lightmap, glm::uvec2 texel) {
    glm::vec4 channels(0.0f);
    glGetTextureSubImage(lightmap.texture, 0, static_cast<GLint>(texel.x), static_cast<GLint>(texel.y), 0, 1,
                         1, 1, GL_RGBA, GL_FLOAT, sizeof channels, &channels);
    return channels;
}

LightmapImage::LightmapImage(const FloatImage& image, const std::string& name) {
    if (image.width != image.height || image.width == 0) {
        throw Error(name + ": " + std::to_string(image.width) + " x " + std::to_string(image.height) +
                    ": a lightmap is square; give the image that 'relume bake' wrote");
    }
    const std::vector<float>* planes[3] = {image.find("R"), image.find("G"), image.find("B")};
    if (planes[0] == nullptr || planes[1] == nullptr || planes[2] == nullptr)
        throw Error(name + ": has no channels R, G and B: give the image that 'relume bake' wrote");
    const std::vector<float>* coverage = image.find("coverage");
    std::vector<glm::vec4> texels(size_t{image.width} * image.height);
    Range range;
    for (size_t i = 0; i < texels.size(); ++i) {
        const glm::vec3 light((*planes[0])[i], (*planes[1])[i], (*planes[2])[i]);
        const float covered = coverage != nullptr ? (*coverage)[i] : 1.0f;
        if (!std::isfinite(light.x + light.y + light.z))
            throw Error(name + ": holds a value that is not finite: bake it again");
        // Nothing may come out of empty texels, whatever the file has there.
        texels[i] = covered > 0.0f ? glm::vec4(light, covered) : glm::vec4(0.0f);
        range.largest = std::max({range.largest, texels[i].x, texels[i].y, texels[i].z});
        if (covered < kCoveredTexel) continue;
        range.sum += light;
        range.count += 1;
    }
    filled_ = isFilled(texels, image.width);
    if (range.count > 0) ambient_ = glm::vec3(range.sum / range.count);
    texture_ = gl::Texture({.width = image.width,
                            .height = image.height,
                            .format = static_cast<GLenum>(fitsHalf(range) ? GL_RGBA16F : GL_RGBA32F),
                            .name = "lightmap"});
    texture_.upload(GL_RGBA, GL_FLOAT, texels.data());
}

} // namespace relume
