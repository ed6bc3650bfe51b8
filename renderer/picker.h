#pragma once

#include <cstdint>
#include <optional>

#include "renderer/id_pass.h"

namespace relume {

/// Tells what is at a pixel of a picture.
struct Pick {
    uint32_t instance = 0,
             material = 0; // into Scene::instances and materials (materials.size(): the default)
    std::optional<glm::vec2> lightmapUv; // none: no lightmap UVs there
    glm::uvec2 texel{0};                 // of the lightmap, where it has UVs
    glm::vec3 position{0.0f};            // [m], world space
};

/// Looks up what a user clicks at.
class Picker {
public:
    Picker();

    struct Query {
        const SceneGpu& scene;
        ViewCamera camera;
        glm::vec2 pixel{0.0f};     // from the picture's upper left corner; a pixel's middle is at 0.5
        glm::vec2 size{1.0f};      // of the picture [pixels]
        uint32_t lightmapSize = 1; // edge [texels]
        std::optional<uint32_t> without = {}; // an instance that is looked through
    };
    /// Returns the nearest surface there, holes of masks left out, or none where nothing is. Waits for the
    /// device.
    std::optional<Pick> pick(const Query& query);

    /// Compiles its programs again. Throws Error and keeps the old ones when one fails.
    void reload() { pass_.reload(); }

private:
    glm::uvec4 look(const IdPass::Desc& desc, IdPass::Output output);

    IdPass pass_;
    gl::Framebuffer pixel_;
};

} // namespace relume
