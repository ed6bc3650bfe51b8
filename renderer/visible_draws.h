#pragma once

#include <vector>

#include "renderer/gl/framebuffer.h"
#include "renderer/gl/program.h"
#include "renderer/scene_gpu.h"

namespace relume {

/// Returns the draws of a scene of which something may be in the picture, so ordered that what is hidden is
/// mostly drawn after what hides it.
std::vector<const SceneDraw*> visibleDraws(const SceneGpu& scene, const glm::mat4& viewProjection,
                                           const glm::vec3& eye);

/// Binds a scene's vertices and materials.
void bindScene(const SceneGpu& scene);
/// Draws with a program that has scene.vert, where the instance stands and with the culling of backs that the
/// draw asks for. Call bindScene before.
void issue(const SceneGpu& scene, const gl::Program& program, const SceneDraw& draw);

/// Binds a framebuffer of reversed depth (1 near, 0 infinitely far) and sets all the state that a scene is
/// drawn with; clears nothing.
void beginScene(const gl::Framebuffer& framebuffer);

} // namespace relume
