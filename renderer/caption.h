#pragma once

#include <string>
#include <vector>

#include "assets/images/float_image.h"

namespace relume {

/// Describes a rectangle of an image [pixels], row 0 on top.
struct CaptionBox {
    uint32_t x = 0, y = 0, width = 0, height = 0;
};

/// Returns the part of a picture of this size that a caption of these lines takes: its lower left corner.
CaptionBox captionBox(uint32_t width, uint32_t height, const std::vector<std::string>& lines);

/// Writes lines of ASCII (anything else becomes ?) into the picture's lower left corner, white on a darkened
/// band: readable whatever lies below. Letters grow with the picture; what does not fit beside or above is
/// cut off. The picture has linear R, G and B, as readPicture() gives it.
void drawCaption(FloatImage& picture, const std::vector<std::string>& lines);

} // namespace relume
