#pragma once

#include <memory>
#include <string>

#include "assets/images/float_image.h"

namespace relume {

/// Where the frames of a series go.
class FrameWriter {
public:
    struct Desc {
        std::string path;               // FILE.mp4, else a folder
        uint32_t width = 0, height = 0; // of all frames [pixels]
        double rate = 2;                // of a video [frames/s]
        double hold = 0;                // how long a video stays on its last frame [s]
        bool overwrite = false;         // frames that are in the folder go when the first new one comes
    };

    virtual ~FrameWriter() = default;
    /// The next frame, so many times. Throws Error.
    virtual void write(const FloatImage& frame, uint32_t times) = 0;
    /// After the last one. Without it a video is not left behind; frames in a folder are. Throws Error.
    virtual void finish() = 0;
    /// Whether frames so far are worth something without finish().
    virtual bool keepsFrames() const = 0;
    uint32_t count() const { return count_; } // frames so far

protected:
    uint32_t count_ = 0;
};

} // namespace relume
