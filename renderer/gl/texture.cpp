#include "renderer/gl/texture.h"

#include "assets/base/error.h"
#include "renderer/gl/errors.h"

#include <algorithm>
#include <bit>

#include <spdlog/fmt/fmt.h>

namespace relume::gl {
namespace {

// Returns the bytes of a texel, exactly enough for a message about memory.
double bytesPerTexel(GLenum format) {
    switch (format) {
    case GL_RGBA32F:
    case GL_RGBA32UI:
        return 16.0;
    case GL_RGBA16F:
    case GL_RG32F:
        return 8.0;
    default:
        return 4.0;
    }
}

void checkSize(const Texture::Desc& desc) {
    const uint32_t largest = largestTexture();
    if (std::max(desc.width, desc.height) > largest) {
        throw Error(
            fmt::format("{}: {} x {} is too large: this OpenGL driver takes at most {} along one side",
                        desc.name, desc.width, desc.height, largest));
    }
}

} // namespace

uint32_t largestTexture() {
    GLint largest = 0;
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
    return static_cast<uint32_t>(largest);
}

uint32_t mipCount(uint32_t width, uint32_t height) {
    return static_cast<uint32_t>(std::bit_width(std::max(width, height)));
}

Texture::Texture(const Desc& desc) : width_(desc.width), height_(desc.height) {
    ASSERT(desc.width > 0 && desc.height > 0);
    checkSize(desc);
    const bool multisample = desc.samples > 0;
    const uint32_t mips = desc.mips > 0 ? desc.mips : mipCount(desc.width, desc.height);
    const auto width = static_cast<GLsizei>(desc.width), height = static_cast<GLsizei>(desc.height);
    GLuint name = 0;
    glCreateTextures(multisample ? GL_TEXTURE_2D_MULTISAMPLE : GL_TEXTURE_2D, 1, &name);
    handle_ = Handle<deleteTexture>(name);
    clearErrors();
    if (multisample) {
        glTextureStorage2DMultisample(name, static_cast<GLsizei>(desc.samples), desc.format, width, height,
                                      GL_TRUE);
    } else {
        glTextureStorage2D(name, static_cast<GLsizei>(mips), desc.format, width, height);
        glTextureParameteri(name, GL_TEXTURE_MIN_FILTER, mips > 1 ? GL_LINEAR_MIPMAP_LINEAR : GL_LINEAR);
        glTextureParameteri(name, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
        glTextureParameteri(name, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    }
    checkMemory(fmt::format("texture '{}' ({} x {})", desc.name, desc.width, desc.height),
                bytesPerTexel(desc.format) * desc.width * desc.height * std::max(desc.samples, 1u));
    label(GL_TEXTURE, name, desc.name);
}

void Texture::upload(GLenum layout, GLenum type, const void* pixels) {
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTextureSubImage2D(get(), 0, 0, 0, static_cast<GLsizei>(width_), static_cast<GLsizei>(height_), layout,
                        type, pixels);
}

} // namespace relume::gl
