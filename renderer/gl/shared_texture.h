#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "renderer/gl/texture.h"

namespace relume::gl {

inline void deleteMemoryObject(GLuint name) {
    glDeleteMemoryObjectsEXT(1, &name);
}

/// Tells whether the current context can draw from memory of another API, and of which devices.
struct GlSharing {
    bool memoryObject = false;                        // GL_EXT_memory_object_fd
    std::vector<std::array<uint8_t, 16>> deviceUuids; // what Vulkan calls deviceUUID
};
GlSharing querySharing();

/// Owns a texture in memory that Vulkan exported: OPTIMAL tiling, a dedicated allocation; move-only. Its
/// users decide who writes it when; it does not synchronise.
class SharedTexture {
public:
    struct Desc {
        int fd = -1;                    // opaque; taken over in any case: it is closed when the import fails
        uint64_t memorySize = 0;        // [bytes], VkMemoryRequirements::size
        uint32_t width = 0, height = 0; // > 0
        GLenum format = GL_RGBA16F;
        const char* name = ""; // for debug messages and captures
    };
    SharedTexture() = default;
    explicit SharedTexture(const Desc& desc); // throws Error when the driver refuses it

    GLuint get() const { return texture_.get(); }
    uint32_t width() const { return width_; }
    uint32_t height() const { return height_; }

private:
    Handle<deleteMemoryObject> memory_; // outlives the texture
    Handle<deleteTexture> texture_;
    uint32_t width_ = 0, height_ = 0;
};

} // namespace relume::gl
