#include "renderer/id_pass.h"

#include "renderer/visible_draws.h"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

namespace relume {
namespace {

// These are the uniforms, as the shaders number them.
constexpr GLint kIdsViewProjection = 0, kIdsMaterial = 1, kIdsLightmapSize = 2;

} // namespace

const gl::Program& IdPass::program(const SceneGpu::MaterialTextures& textures, Output output) {
    const uint32_t masked = textures.masked ? 1 : 0, base = textures.masked && textures.base != 0 ? 1 : 0;
    const auto number = static_cast<uint32_t>(output);
    return programs_.get(number | masked << 2 | base << 3, [&]() -> gl::Program::Desc {
        return {.vertex = "gl/scene.vert",
                .fragment = "gl/ids.frag",
                .definitions = {"OUTPUT=" + std::to_string(number), "MASKED=" + std::to_string(masked),
                                "BASE=" + std::to_string(base)},
                .name = "ids"};
    });
}

void IdPass::draw(const Desc& desc, Output output, const gl::Framebuffer& to) {
    beginScene(to);
    const std::array<GLuint, 4> nothing = {0, 0, 0, 0};
    const float farAway = 0;
    glClearNamedFramebufferuiv(to.get(), GL_COLOR, 0, nothing.data());
    glClearNamedFramebufferfv(to.get(), GL_DEPTH, 0, &farAway);
    bindScene(desc.scene);
    std::vector<const gl::Program*> ready; // have the uniforms
    for (const SceneDraw* draw : visibleDraws(desc.scene, desc.viewProjection, desc.eye)) {
        if (draw->instance == desc.without || (draw->pane && !desc.panes)) continue;
        const SceneGpu::MaterialTextures& textures = desc.scene.textures(draw->material);
        const gl::Program& variant = program(textures, output);
        if (std::find(ready.begin(), ready.end(), &variant) == ready.end()) {
            ready.push_back(&variant);
            variant.set(kIdsViewProjection, desc.viewProjection);
            variant.set(kIdsLightmapSize, static_cast<GLuint>(desc.lightmapSize));
        }
        variant.set(kIdsMaterial, static_cast<GLuint>(draw->material));
        glBindTextureUnit(0, textures.base);
        issue(desc.scene, variant, *draw);
    }
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
}

} // namespace relume
