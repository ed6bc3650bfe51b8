#include "renderer/gl/pixel_buffer.h"

#include "assets/base/error.h"

#include <string>

namespace relume::gl {

PixelBuffer::PixelBuffer(const Desc& desc) : width_(desc.width), height_(desc.height) {
    ASSERT(desc.width > 0 && desc.height > 0);
    constexpr GLbitfield kAccess = GL_MAP_WRITE_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
    const size_t size = kTexelBytes * desc.width * desc.height;
    buffer_ = Buffer({.size = static_cast<GLsizeiptr>(size), .flags = kAccess, .name = desc.name});
    void* mapped = glMapNamedBufferRange(buffer_.get(), 0, static_cast<GLsizeiptr>(size), kAccess);
    if (mapped == nullptr)
        throw Error(std::string("OpenGL cannot map buffer '") + desc.name + "': bring the driver up to date");
    bytes_ = {static_cast<std::byte*>(mapped), size};
}

void PixelBuffer::upload(GLuint texture, const Rect& rect) const {
    ASSERT(rect.x + rect.width <= width_ && rect.y + rect.height <= height_);
    if (rect.width == 0 || rect.height == 0) return;
    const size_t offset = kTexelBytes * (size_t{rect.y} * width_ + rect.x);
    glBindBuffer(GL_PIXEL_UNPACK_BUFFER, buffer_.get());
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glPixelStorei(GL_UNPACK_ROW_LENGTH, static_cast<GLint>(width_));
    glTextureSubImage2D(texture, 0, static_cast<GLint>(rect.x), static_cast<GLint>(rect.y),
                        static_cast<GLsizei>(rect.width), static_cast<GLsizei>(rect.height), GL_RGBA,
                        GL_HALF_FLOAT, reinterpret_cast<const void*>(offset));
    glPixelStorei(GL_UNPACK_ROW_LENGTH, 0);
    glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
}

void PixelBuffer::uploadRows(GLuint texture, uint32_t first, uint32_t count) const {
    upload(texture, {.x = 0, .y = first, .width = width_, .height = count});
}

} // namespace relume::gl
