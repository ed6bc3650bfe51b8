#pragma once

#include <functional>
#include <memory>
#include <string>

#include "assets/images/float_image.h"

namespace relume {

/// Writes the frames of a series.
class FrameWriter {
public:
    struct Desc {
        std::string path; // FILE.mp4, else a folder
        /// This tells names for a video where it is set, one per call; the video takes the first that nothing
        /// has, not `path`.
        std::function<std::string()> nextName = nullptr;
        uint32_t width = 0, height = 0; // of all frames [pixels]
        double rate = 2;                // of a video [frames/s], within the next two
        double hold = 0;                // how long a video stays on its last frame [s]
        bool overwrite = false;         // old frames in the folder go when the first new one comes
    };

    static constexpr double kLeastRate = 0.1, kMostRate = 120.0;

    virtual ~FrameWriter() = default;
    /// Writes the next frame so many times. Throws Error.
    virtual void write(const FloatImage& frame, uint32_t times) = 0;
    /// Ends the series after the last frame and returns the path that it has. Without it, frames in a folder
    /// stay but a video does not. Throws Error.
    virtual std::string finish() = 0;
    /// Tells whether the frames so far are worth something without finish().
    virtual bool keepsFrames() const = 0;
    uint32_t count() const { return count_; } // frames so far

protected:
    uint32_t count_ = 0;
};

} // namespace relume
