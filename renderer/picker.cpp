#include "renderer/picker.h"

#include "renderer/shader_types.h"

#include <glm/gtc/matrix_transform.hpp>

namespace relume {
namespace {

// Returns the transform that makes a picture of one pixel out of one of `size`.
glm::mat4 onlyPixel(const glm::vec2& pixel, const glm::vec2& size) {
    const glm::vec2 ndc(2.0f * pixel.x / size.x - 1.0f, 1.0f - 2.0f * pixel.y / size.y);
    const glm::mat4 scale = glm::scale(glm::mat4(1.0f), glm::vec3(size, 1.0f));
    return glm::translate(scale, glm::vec3(-ndc, 0.0f));
}

} // namespace

Picker::Picker()
    : pixel_({.width = 1,
              .height = 1,
              .color = GL_RGBA32UI,
              .depth = GL_DEPTH_COMPONENT32F,
              .name = "picked pixel"}) {}

glm::uvec4 Picker::look(const IdPass::Desc& desc, IdPass::Output output) {
    pass_.draw(desc, output, pixel_);
    glm::uvec4 value(0);
    glGetTextureImage(pixel_.color().get(), 0, GL_RGBA_INTEGER, GL_UNSIGNED_INT, sizeof(value), &value.x);
    return value;
}

std::optional<Pick> Picker::pick(const Query& query) {
    const glm::mat4 viewProjection = onlyPixel(query.pixel, query.size) *
                                     projectionMatrix(query.camera, query.size.x / query.size.y) *
                                     viewMatrix(query.camera);
    const IdPass::Desc desc{.scene = query.scene,
                            .viewProjection = viewProjection,
                            .eye = query.camera.eye,
                            .lightmapSize = query.lightmapSize,
                            .without = query.without,
                            .panes = true};
    const glm::uvec4 surface = look(desc, IdPass::Output::Surface);
    if (surface.x == 0) return std::nullopt;
    const glm::uvec4 position = look(desc, IdPass::Output::Position);
    Pick pick;
    pick.instance = surface.x - 1;
    pick.material = surface.y;
    pick.position = glm::uintBitsToFloat(glm::uvec3(position.y, position.z, position.w));
    if (surface.z == shader::kNoUv) return pick;
    const glm::vec2 uv = glm::uintBitsToFloat(glm::uvec2(surface.z, surface.w));
    pick.lightmapUv = uv;
    const auto edge = static_cast<float>(query.lightmapSize);
    pick.texel = glm::uvec2(glm::clamp(uv * edge, 0.0f, edge - 1.0f));
    return pick;
}

} // namespace relume
