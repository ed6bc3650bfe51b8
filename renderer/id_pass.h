#pragma once

#include <optional>

#include "renderer/camera.h"
#include "renderer/gl/framebuffer.h"
#include "renderer/gl/program_cache.h"
#include "renderer/scene_gpu.h"

namespace relume {

/// Draws what a scene's surfaces are in place of their colours.
class IdPass {
public:
    enum class Output : uint32_t {
        Tile,    // R: 1 + lightmap tile, 0 where there is none
        Surface, // R: 1 + instance, G: material, B and A: lightmap uv as floats, kNoUv where there is none
        Position // R: 1, GBA: world position as floats
    };
    struct Desc {
        const SceneGpu& scene;
        glm::mat4 viewProjection{1.0f};
        glm::vec3 eye{0.0f};
        uint32_t lightmapSize = 0;            // edge [texels], > 0
        std::optional<uint32_t> without = {}; // an instance that is left out
        bool panes = false;                   // they are drawn too; else what is behind them is seen
    };

    /// Draws into a framebuffer of unsigned integers with depth: R32UI for Tile, else RGBA32UI. Throws Error
    /// when the shader does not compile.
    void draw(const Desc& desc, Output output, const gl::Framebuffer& to);
    /// Compiles its programs again. Throws Error and keeps the old ones when one fails.
    void reload() { programs_ = programs_.reloaded(); }

private:
    const gl::Program& program(const SceneGpu::MaterialTextures& textures, Output output);

    gl::ProgramCache programs_;
};

} // namespace relume
