#pragma once

#include <cstdint>

#include "renderer/gl/program.h"
#include "renderer/gl/vertex_array.h"

namespace relume::gl {

/// Runs a fragment shader, behind gl/screen.vert, over all pixels of a framebuffer.
class Screen {
public:
    Screen() : empty_({.attributes = {}, .name = "screen"}) {}

    void draw(const Program& program, GLuint framebuffer, uint32_t width, uint32_t height) const;

private:
    VertexArray empty_; // without vertices
};

} // namespace relume::gl
