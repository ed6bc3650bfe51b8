#pragma once

#include <string>

namespace relume {

/// Tells whether a series would have a file of this name: "frame_0001.png".
bool isFrameName(const std::string& name);

/// Tells whether frames for this path become a video.
bool isVideo(const std::string& path);

} // namespace relume
