#pragma once

#include <utility>

#include <epoxy/gl.h>

namespace relume::gl {

/// Owns the name of an OpenGL object; move-only. It is made and destroyed while the context that it belongs
/// to is current.
template<void (*Delete)(GLuint)>
class Handle {
public:
    Handle() = default;
    explicit Handle(GLuint name) : name_(name) {}
    ~Handle() { reset(); }
    Handle(Handle&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
    Handle& operator=(Handle&& other) noexcept {
        if (this != &other) {
            reset();
            name_ = std::exchange(other.name_, 0);
        }
        return *this;
    }

    GLuint get() const { return name_; }
    explicit operator bool() const { return name_ != 0; }

private:
    void reset() {
        if (name_ != 0) Delete(std::exchange(name_, 0));
    }

    GLuint name_ = 0; // 0: none
};

/// Names an object for debug messages and captures. `kind` is GL_BUFFER, GL_TEXTURE, ...
inline void label(GLenum kind, GLuint object, const char* name) {
    if (name[0] != '\0') glObjectLabel(kind, object, -1, name);
}

} // namespace relume::gl
