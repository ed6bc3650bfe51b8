#pragma once

#include <span>

#include "renderer/gl/handle.h"

namespace relume::gl {

inline void deleteBuffer(GLuint name) {
    glDeleteBuffers(1, &name);
}

/// Owns a buffer of immutable size; move-only.
class Buffer {
public:
    struct Desc {
        GLsizeiptr size = 0;        // [bytes], > 0
        const void* data = nullptr; // its first contents, nullptr: undefined
        GLbitfield flags = 0;       // of glNamedBufferStorage
        const char* name = "";      // for debug messages and captures
    };
    Buffer() = default;
    explicit Buffer(const Desc& desc); // throws Error when there is no memory

    template<typename T>
    static Buffer of(std::span<const T> items, const char* name) {
        return Buffer(
            {.size = static_cast<GLsizeiptr>(items.size_bytes()), .data = items.data(), .name = name});
    }

    GLuint get() const { return handle_.get(); }

private:
    Handle<deleteBuffer> handle_;
};

} // namespace relume::gl
