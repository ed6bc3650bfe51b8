#pragma once

#include <cstdint>

#include "renderer/gl/handle.h"

namespace relume::gl {

inline void deleteTexture(GLuint name) {
    glDeleteTextures(1, &name);
}

/// Owns a 2D texture of immutable size; move-only. It starts with linear filters (through the mips where it
/// has them) and clamped edges.
class Texture {
public:
    struct Desc {
        uint32_t width = 0, height = 0; // > 0
        GLenum format = GL_RGBA8;       // sized internal format
        uint32_t mips = 1;              // 0: down to 1 x 1
        uint32_t samples = 0;           // 0: an ordinary texture; else of a multisample one
        const char* name = "";          // for debug messages and captures
    };
    Texture() = default;
    explicit Texture(
        const Desc& desc); // throws Error when it is too large for the driver or there is no memory

    /// Writes all of level 0 from pixels, tightly packed: e.g. GL_RGBA and GL_UNSIGNED_BYTE.
    void upload(GLenum layout, GLenum type, const void* pixels);
    /// Makes the smaller mips from level 0.
    void generateMips() { glGenerateTextureMipmap(get()); }

    GLuint get() const { return handle_.get(); }
    uint32_t width() const { return width_; }
    uint32_t height() const { return height_; }

private:
    Handle<deleteTexture> handle_;
    uint32_t width_ = 0, height_ = 0;
};

/// Returns how many texels a texture of the current context may have along a side.
uint32_t largestTexture();

/// Returns how many levels a whole chain of mips has.
uint32_t mipCount(uint32_t width, uint32_t height);

} // namespace relume::gl
