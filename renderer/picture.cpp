#include "renderer/picture.h"

#include <array>

namespace relume {

FloatImage readPicture(const gl::Framebuffer& framebuffer) {
    const uint32_t width = framebuffer.width(), height = framebuffer.height();
    std::vector<uint8_t> pixels(size_t{4} * width * height);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glGetTextureImage(framebuffer.color().get(), 0, GL_RGBA, GL_UNSIGNED_BYTE,
                      static_cast<GLsizei>(pixels.size()), pixels.data());
    std::array<float, 256> linear{};
    for (size_t i = 0; i < linear.size(); ++i)
        linear[i] = static_cast<float>(linearFromSrgb(static_cast<double>(i) / 255.0));
    FloatImage image{width, height, {}, {}, {}};
    for (size_t channel = 0; channel < 3; ++channel) {
        std::vector<float>& plane = image.add(std::array{"R", "G", "B"}[channel]);
        for (uint32_t y = 0; y < height; ++y) {
            const size_t source = size_t{height - 1 - y} * width; // OpenGL's first row is the lowest
            for (uint32_t x = 0; x < width; ++x)
                plane[size_t{y} * width + x] = linear[pixels[4 * (source + x) + channel]];
        }
    }
    return image;
}

} // namespace relume
