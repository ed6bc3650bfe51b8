#pragma once

#include <vector>

#include "renderer/gl/handle.h"
#include "renderer/gl/texture.h"

namespace relume::gl {

inline void deleteFramebuffer(GLuint name) {
    glDeleteFramebuffers(1, &name);
}

/// Owns a colour texture to draw into, with a depth texture where one is asked for; move-only.
class Framebuffer {
public:
    struct Desc {
        uint32_t width = 0, height = 0; // > 0
        GLenum color = GL_RGBA8;        // sized internal format
        GLenum depth = 0;               // the same, 0: none
        uint32_t samples = 0;           // 0: no multisampling
        const char* name = "";
    };
    Framebuffer() = default;
    explicit Framebuffer(const Desc& desc); // throws Error when the driver cannot draw into it

    GLuint get() const { return handle_.get(); }
    const Texture& color() const { return color_; }
    uint32_t width() const { return color_.width(); }
    uint32_t height() const { return color_.height(); }

private:
    Texture color_, depth_;
    Handle<deleteFramebuffer> handle_;
};

} // namespace relume::gl
