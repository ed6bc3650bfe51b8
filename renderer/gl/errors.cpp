#include "renderer/gl/errors.h"

#include "assets/base/error.h"

#include <epoxy/gl.h>
#include <spdlog/fmt/fmt.h>

namespace relume::gl {
namespace {

const char* nameOf(GLenum error) {
    switch (error) {
    case GL_INVALID_ENUM:
        return "invalid enum";
    case GL_INVALID_VALUE:
        return "invalid value";
    case GL_INVALID_OPERATION:
        return "invalid operation";
    case GL_OUT_OF_MEMORY:
        return "out of memory";
    case GL_INVALID_FRAMEBUFFER_OPERATION:
        return "invalid framebuffer operation";
    default:
        return "unknown error";
    }
}

} // namespace

void clearErrors() {
    // A lost context reports errors for ever.
    for (int i = 0; i < 16 && glGetError() != GL_NO_ERROR; ++i) {
    }
}

void checkMemory(const std::string& what, double bytes) {
    const GLenum error = glGetError();
    if (error == GL_NO_ERROR) return;
    throw Error(
        fmt::format("OpenGL cannot make {} of {:.1f} MB ({}): use a smaller picture, lightmap or scene", what,
                    bytes * 1e-6, nameOf(error)));
}

} // namespace relume::gl
