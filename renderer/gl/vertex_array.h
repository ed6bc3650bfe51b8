#pragma once

#include <span>

#include "renderer/gl/buffer.h"

namespace relume::gl {

inline void deleteVertexArray(GLuint name) {
    glDeleteVertexArrays(1, &name);
}

/// Describes one attribute of a vertex, at the location of its place in the list.
struct VertexAttribute {
    GLint components = 3;
    GLenum type = GL_FLOAT; // GL_UNSIGNED_INT: an integer in the shader
    GLuint offset = 0;      // [bytes] in the vertex
};

/// Tells how vertices and indices are read from two buffers, which must outlive it; move-only.
class VertexArray {
public:
    struct Desc {
        const Buffer* vertices = nullptr; // nullptr: the shader makes them up
        const Buffer* indices = nullptr;  // 32 bits each
        GLsizei stride = 0;               // [bytes]
        std::span<const VertexAttribute> attributes;
        const char* name = "";
    };
    VertexArray() = default;
    explicit VertexArray(const Desc& desc);

    GLuint get() const { return handle_.get(); }

private:
    Handle<deleteVertexArray> handle_;
};

} // namespace relume::gl
