#include "renderer/gl/framebuffer.h"

#include "assets/base/error.h"

#include <string>

#include <spdlog/fmt/fmt.h>

namespace relume::gl {

Framebuffer::Framebuffer(const Desc& desc) {
    const std::string colorName = std::string(desc.name) + " colour",
                      depthName = std::string(desc.name) + " depth";
    color_ = Texture({.width = desc.width,
                      .height = desc.height,
                      .format = desc.color,
                      .samples = desc.samples,
                      .name = colorName.c_str()});
    GLuint name = 0;
    glCreateFramebuffers(1, &name);
    handle_ = Handle<deleteFramebuffer>(name);
    glNamedFramebufferTexture(name, GL_COLOR_ATTACHMENT0, color_.get(), 0);
    if (desc.depth != 0) {
        depth_ = Texture({.width = desc.width,
                          .height = desc.height,
                          .format = desc.depth,
                          .samples = desc.samples,
                          .name = depthName.c_str()});
        glNamedFramebufferTexture(name, GL_DEPTH_ATTACHMENT, depth_.get(), 0);
    }
    const GLenum status = glCheckNamedFramebufferStatus(name, GL_DRAW_FRAMEBUFFER);
    if (status != GL_FRAMEBUFFER_COMPLETE) {
        throw Error(
            fmt::format("OpenGL cannot draw into '{}' ({} x {}, {} samples): status {:#x}; bring the driver "
                        "up to date",
                        desc.name, desc.width, desc.height, desc.samples, status));
    }
    label(GL_FRAMEBUFFER, name, desc.name);
}

} // namespace relume::gl
