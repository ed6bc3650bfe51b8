#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "renderer/gl/readback.h"
#include "renderer/id_pass.h"

namespace relume {

/// Tells which surfaces a camera sees, by a small picture of them. Nothing waits for the device.
class SurfaceIds {
public:
    static constexpr uint32_t kWidth = 64, kHeight = 36; // [pixels]

    struct Surface {
        bool any = false; // else nothing is there
        uint32_t instance = 0, material = 0;
        std::optional<glm::vec2> lightmapUv; // none: no lightmap UVs there
    };
    /// Asks for the surfaces, in place of what was asked for before. Throws Error when the shader does not
    /// compile.
    void request(const SceneGpu& scene, const ViewCamera& camera);
    bool pending() const { return readback_.pending(); }
    /// Returns the surfaces once after each request, as soon as they are there: kWidth * kHeight, the upper
    /// row first.
    std::optional<std::vector<Surface>> poll();

    /// Compiles its programs again. Throws Error and keeps the old ones when one fails.
    void reload() { pass_.reload(); }

private:
    IdPass pass_;
    gl::Framebuffer picture_;
    gl::Readback readback_;
};

} // namespace relume
