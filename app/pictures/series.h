#pragma once

#include <span>
#include <string>
#include <vector>

#include "app/pictures/frame_writer.h"
#include "app/pictures/picture_studio.h"

namespace relume {

/// The pictures of a moving camera.
struct CameraSeries {
    std::vector<ViewCamera> cameras;
    std::vector<std::string> captions; // the second line of each picture's caption
    std::string title;                 // the first line; "": the pictures have no caption
};

/// Returns the turn of a camera in a scene with these bounds.
CameraSeries turnSeries(const ViewCamera& camera, const Box& bounds, uint32_t count);

/// Returns the way through all stops, which takes so many seconds at so many pictures per second.
CameraSeries pathSeries(std::span<const ViewCamera> stops, double seconds, double rate);

/// Says at which of `seconds` each picture of a series is taken.
void captionByTime(CameraSeries& series, double seconds);

/// Takes the pictures, all with the exposure of the first, and ends the series. Throws Error, and what an
/// interrupt throws.
void takeSeries(PictureStudio& studio, const LightmapTexture& lightmap, DrawSettings draw,
                const CameraSeries& series, FrameWriter& writer);

} // namespace relume
