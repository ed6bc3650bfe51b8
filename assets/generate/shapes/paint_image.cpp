#include "assets/generate/shapes/paint_image.h"

#include "assets/generate/shapes/solid.h"

#include <algorithm>
#include <cmath>

namespace relume::generate {
namespace {

uint8_t byteOf(double x) {
    return static_cast<uint8_t>(roundSteadily(255.0 * std::clamp(x, 0.0, 1.0)));
}

} // namespace

Image paintMasked(const std::string& name, uint32_t width, uint32_t height, const MaskPainter& painter) {
    Image image{name, width, height, {}};
    image.rgba.reserve(size_t{4} * width * height);
    for (uint32_t y = 0; y < height; ++y)
        for (uint32_t x = 0; x < width; ++x) {
            const glm::dvec4 color = painter({(x + 0.5) / width, (y + 0.5) / height});
            for (int i = 0; i < 4; ++i)
                image.rgba.push_back(byteOf(color[i]));
        }
    return image;
}

Image paintImage(const std::string& name, uint32_t width, uint32_t height, const Painter& painter) {
    return paintMasked(name, width, height,
                       [&](glm::dvec2 place) { return glm::dvec4(painter(place), 1.0); });
}

double random(uint32_t x, uint32_t y, uint32_t seed) {
    uint32_t h = x * 0x8da6b343u ^ y * 0xd8163841u ^ seed * 0xcb1ab31fu;
    h = (h ^ (h >> 15)) * 0x2c1b3c6du;
    h = (h ^ (h >> 12)) * 0x297a2d39u;
    return (h ^ (h >> 15)) / 4294967296.0;
}

double noise(const glm::dvec2& p, uint32_t periodX, uint32_t periodY, uint32_t seed) {
    const glm::dvec2 cell = glm::floor(p);
    const glm::dvec2 f = p - cell;
    const glm::dvec2 w = f * f * (3.0 - 2.0 * f);
    const auto x = static_cast<uint32_t>(static_cast<int>(cell.x)) % periodX;
    const auto y = static_cast<uint32_t>(static_cast<int>(cell.y)) % periodY;
    const uint32_t right = (x + 1) % periodX, below = (y + 1) % periodY;
    return glm::mix(glm::mix(random(x, y, seed), random(right, y, seed), w.x),
                    glm::mix(random(x, below, seed), random(right, below, seed), w.x), w.y);
}

double step(double low, double high, double x) {
    const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}

} // namespace relume::generate
