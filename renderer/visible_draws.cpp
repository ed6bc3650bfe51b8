#include "renderer/visible_draws.h"

#include "renderer/frustum.h"

#include <algorithm>
#include <utility>

namespace relume {
namespace {

// These are the uniforms, as scene.vert numbers them.
constexpr GLint kPlacement = 13, kTurning = 14;

float farthest(const Box& box, const glm::vec3& eye) { // squared
    const glm::vec3 reach = glm::max(glm::abs(box.low - eye), glm::abs(box.high - eye));
    return glm::dot(reach, reach);
}

} // namespace

std::vector<const SceneDraw*> visibleDraws(const SceneGpu& scene, const glm::mat4& viewProjection,
                                           const glm::vec3& eye) {
    const Frustum frustum(viewProjection);
    std::vector<std::pair<float, const SceneDraw*>> seen;
    seen.reserve(scene.draws().size());
    for (const SceneDraw& draw : scene.draws()) {
        if (scene.place(draw.instance).hidden) continue;
        const Box bounds = scene.boundsOf(draw);
        if (frustum.sees(bounds)) seen.emplace_back(farthest(bounds, eye), &draw);
    }
    // They are sorted by their far ends: a room is behind what stands in it.
    std::stable_sort(seen.begin(), seen.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<const SceneDraw*> visible;
    visible.reserve(seen.size());
    for (const auto& [distance, draw] : seen)
        visible.push_back(draw);
    return visible;
}

void bindScene(const SceneGpu& scene) {
    glBindVertexArray(scene.vertexArray().get());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, scene.materials().get());
}

void issue(const SceneGpu& scene, const gl::Program& program, const SceneDraw& draw) {
    const SceneGpu::Place& place = scene.place(draw.instance);
    program.set(kPlacement, place.transform);
    program.set(kTurning, place.normals);
    program.use();
    glFrontFace(place.mirrored ? GL_CW : GL_CCW);
    if (draw.doubleSided)
        glDisable(GL_CULL_FACE);
    else
        glEnable(GL_CULL_FACE);
    glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(draw.indexCount), GL_UNSIGNED_INT,
                   reinterpret_cast<const void*>(sizeof(uint32_t) * size_t{draw.firstIndex}));
}

void beginScene(const gl::Framebuffer& framebuffer) {
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.get());
    glViewport(0, 0, static_cast<GLsizei>(framebuffer.width()), static_cast<GLsizei>(framebuffer.height()));
    glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_GREATER);
    glDepthMask(GL_TRUE);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glDisable(GL_BLEND);
    glDisable(GL_SCISSOR_TEST);
    glDisable(GL_FRAMEBUFFER_SRGB);
    glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
    glFrontFace(GL_CCW);
    glCullFace(GL_BACK);
}

} // namespace relume
