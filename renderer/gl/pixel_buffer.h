#pragma once

#include <cstddef>
#include <span>

#include "renderer/gl/buffer.h"

namespace relume::gl {

/// Holds texels (GL_RGBA, half floats) on their way into a texture: memory of the driver that any thread may
/// write, mapped as long as this lives; move-only. Its users decide who writes and who uploads when.
class PixelBuffer {
public:
    struct Desc {
        uint32_t width = 0, height = 0; // > 0
        const char* name = "";          // for debug messages and captures
    };
    struct Rect {
        uint32_t x = 0, y = 0, width = 0, height = 0; // [texels]
    };
    static constexpr size_t kTexelBytes = 8;

    PixelBuffer() = default;
    explicit PixelBuffer(const Desc& desc); // throws Error when there is no memory

    /// Returns all rows, tightly packed, row 0 first. What is written is seen by uploads issued afterwards;
    /// it must stay until a Fence behind the upload is signalled.
    std::span<std::byte> bytes() const { return bytes_; }

    /// Copies to the same place of a texture at least as large; does not wait.
    void upload(GLuint texture, const Rect& rect) const;
    void uploadRows(GLuint texture, uint32_t first, uint32_t count) const;

    uint32_t width() const { return width_; }
    uint32_t height() const { return height_; }

private:
    Buffer buffer_;
    std::span<std::byte> bytes_;
    uint32_t width_ = 0, height_ = 0;
};

} // namespace relume::gl
