#pragma once

#include <cstdint>

#include "app/pictures/frame_writer.h"
#include "app/pictures/picture_studio.h"

namespace relume {

/// Takes the pictures of a turn of the studio's camera in the scene of this mesh, all with the exposure of
/// the first, and ends the series. Throws Error, and what an interrupt throws.
void takeTurn(PictureStudio& studio, const LightmapTexture& lightmap, DrawSettings draw,
              const WorldMesh& mesh, uint32_t count, FrameWriter& writer);

} // namespace relume
