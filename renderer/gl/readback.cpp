#include "renderer/gl/readback.h"

#include "assets/base/error.h"

#include <string>

namespace relume::gl {

Readback::Readback(const Desc& desc) {
    constexpr GLbitfield kAccess = GL_MAP_READ_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
    const auto size = static_cast<GLsizeiptr>(desc.size);
    buffer_ = Buffer({.size = size, .flags = kAccess | GL_CLIENT_STORAGE_BIT, .name = desc.name});
    const void* mapped = glMapNamedBufferRange(buffer_.get(), 0, size, kAccess);
    if (mapped == nullptr)
        throw Error(std::string("OpenGL cannot map buffer '") + desc.name + "': bring the driver up to date");
    bytes_ = {static_cast<const std::byte*>(mapped), desc.size};
}

void Readback::request(const Framebuffer& framebuffer, GLenum layout, GLenum type) {
    glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer.get());
    glBindBuffer(GL_PIXEL_PACK_BUFFER, buffer_.get());
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadnPixels(0, 0, static_cast<GLsizei>(framebuffer.width()), static_cast<GLsizei>(framebuffer.height()),
                  layout, type, static_cast<GLsizei>(bytes_.size()), nullptr);
    glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
    fence_ = Fence::insert();
    pending_ = true;
}

std::optional<std::span<const std::byte>> Readback::poll() {
    if (!pending_ || !fence_.signalled()) return std::nullopt;
    pending_ = false;
    return bytes_;
}

std::span<const std::byte> Readback::wait() {
    ASSERT(pending_);
    fence_.wait();
    pending_ = false;
    return bytes_;
}

} // namespace relume::gl
