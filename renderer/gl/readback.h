#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "renderer/gl/buffer.h"
#include "renderer/gl/fence.h"
#include "renderer/gl/framebuffer.h"

namespace relume::gl {

/// Brings pixels to the host without waiting for the device; move-only.
class Readback {
public:
    struct Desc {
        size_t size = 0;       // [bytes], of the largest picture that is read
        const char* name = ""; // for debug messages and captures
    };
    Readback() = default;
    explicit Readback(const Desc& desc); // throws Error when there is no memory

    /// Asks for the colour of a framebuffer without multisampling, rows tightly packed, the lowest first.
    /// What was asked for before and not fetched is forgotten.
    void request(const Framebuffer& framebuffer, GLenum layout, GLenum type);
    bool pending() const { return pending_; }
    /// Returns what was asked for, once, as soon as it is there; it is valid until the next request. Never
    /// waits.
    std::optional<std::span<const std::byte>> poll();
    /// Returns what was asked for, and waits for it; something must have been asked for.
    std::span<const std::byte> wait();

private:
    Buffer buffer_;
    std::span<const std::byte> bytes_;
    Fence fence_;
    bool pending_ = false;
};

} // namespace relume::gl
