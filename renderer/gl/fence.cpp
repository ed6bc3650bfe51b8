#include "renderer/gl/fence.h"

#include <utility>

namespace relume::gl {

Fence::~Fence() {
    reset();
}

Fence::Fence(Fence&& other) noexcept : sync_(std::exchange(other.sync_, nullptr)) {}

Fence& Fence::operator=(Fence&& other) noexcept {
    if (this != &other) {
        reset();
        sync_ = std::exchange(other.sync_, nullptr);
    }
    return *this;
}

Fence Fence::insert() {
    Fence fence;
    fence.sync_ = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
    return fence;
}

bool Fence::signalled() {
    return waitFor(0);
}

void Fence::wait() {
    constexpr GLuint64 kSecond = 1'000'000'000; // [ns]; a software device may take longer, hence the loop
    while (!waitFor(kSecond)) {
    }
}

bool Fence::waitFor(GLuint64 nanoseconds) {
    if (sync_ == nullptr) return true;
    // Without the flush a fence that was never sent off would never be signalled.
    if (glClientWaitSync(sync_, GL_SYNC_FLUSH_COMMANDS_BIT, nanoseconds) == GL_TIMEOUT_EXPIRED) return false;
    reset(); // also when the context is lost: nobody shall wait for it
    return true;
}

void Fence::reset() {
    if (sync_ != nullptr) glDeleteSync(std::exchange(sync_, nullptr));
}

} // namespace relume::gl
