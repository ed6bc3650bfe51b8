#pragma once

#include <epoxy/gl.h>

namespace relume::gl {

/// Tells when the commands issued before it are done; move-only. One that was never inserted counts as done.
class Fence {
public:
    Fence() = default;
    ~Fence();
    Fence(Fence&& other) noexcept;
    Fence& operator=(Fence&& other) noexcept;

    /// Inserts a fence behind all commands issued so far in the current context.
    static Fence insert();

    /// Tells whether the commands are done; never waits.
    [[nodiscard]] bool signalled();
    void wait();

private:
    bool waitFor(GLuint64 nanoseconds);
    void reset();

    GLsync sync_ = nullptr;
};

} // namespace relume::gl
