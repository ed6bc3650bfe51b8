#pragma once

#include "assets/images/float_image.h"
#include "renderer/gl/headless_context.h"
#include "renderer/scene_renderer.h"

namespace relume {

/// Returns the one OpenGL context of this test process, with its debug messages on: a test during which it
/// says anything fails.
const gl::HeadlessContext& testContext();

/// Says what a test draws.
struct PictureDesc {
    const Scene& scene;
    const FloatImage* lightmap = nullptr; // nullptr: none yet
    ViewCamera camera;
    DrawSettings settings;
    uint32_t width = 64, height = 64, samples = 4;
};

struct Picture {
    FloatImage image;
    SceneRenderer::Counts counts;
    float exposure = 0;

    /// Returns what the PNG would have in R, G, B at a pixel, row 0 on top.
    glm::ivec3 pixel(uint32_t x, uint32_t y) const;
};

Picture drawPicture(const PictureDesc& desc);

} // namespace relume
