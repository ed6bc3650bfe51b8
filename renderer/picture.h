#pragma once

#include "assets/images/float_image.h"
#include "renderer/gl/framebuffer.h"

namespace relume {

/// Reads a finished picture (GL_RGBA8, sRGB encoded) as an image of linear R, G and B, its upper row first;
/// written as PNG it is the same again.
FloatImage readPicture(const gl::Framebuffer& framebuffer);

} // namespace relume
