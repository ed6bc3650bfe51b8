#include "renderer/surface_ids.h"

#include "renderer/shader_types.h"

#include <cstring>

namespace relume {

void SurfaceIds::request(const SceneGpu& scene, const ViewCamera& camera) {
    if (picture_.get() == 0) {
        picture_ = gl::Framebuffer({.width = kWidth,
                                    .height = kHeight,
                                    .color = GL_RGBA32UI,
                                    .depth = GL_DEPTH_COMPONENT32F,
                                    .name = "surfaces"});
        readback_ = gl::Readback({.size = sizeof(glm::uvec4) * kWidth * kHeight, .name = "surfaces"});
    }
    const float aspect = static_cast<float>(kWidth) / static_cast<float>(kHeight);
    pass_.draw({.scene = scene,
                .viewProjection = projectionMatrix(camera, aspect) * viewMatrix(camera),
                .eye = camera.eye,
                .lightmapSize = 1},
               IdPass::Output::Surface, picture_);
    readback_.request(picture_, GL_RGBA_INTEGER, GL_UNSIGNED_INT);
}

std::optional<std::vector<SurfaceIds::Surface>> SurfaceIds::poll() {
    const auto bytes = readback_.poll();
    if (!bytes) return std::nullopt;
    std::vector<glm::uvec4> values(size_t{kWidth} * kHeight);
    std::memcpy(values.data(), bytes->data(), bytes->size());
    std::vector<Surface> surfaces(values.size());
    for (size_t i = 0; i < values.size(); ++i) {
        const glm::uvec4& value = values[(kHeight - 1 - i / kWidth) * kWidth + i % kWidth];
        if (value.x == 0) continue;
        surfaces[i] = {.any = true, .instance = value.x - 1, .material = value.y, .lightmapUv = {}};
        if (value.z != shader::kNoUv)
            surfaces[i].lightmapUv = glm::uintBitsToFloat(glm::uvec2(value.z, value.w));
    }
    return surfaces;
}

} // namespace relume
