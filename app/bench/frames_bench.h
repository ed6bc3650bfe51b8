#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "app/live/bake_desk.h"
#include "app/offline/bake_options.h"

namespace relume {

/// Says what `relume bench frames` measures: how a bake and the drawing of its scene get on with each other.
struct FramesBenchDesc {
    BakeOptions bake; // its error and samples are unused, because the bake goes on
    DisplayMode display = DisplayMode::Auto;
    uint32_t width = 1920, height = 1080; // of the pictures
    double seconds = 8;                   // of each part
    double rate = 60;                     // frames per second at most, as a display would have it; 0: as many
                                          // as there can be
    double budget = 8;                    // how long one batch should take [ms]
    uint32_t samples = 4;                 // of each pixel
};

/// One part of the measurement.
struct FramesPart {
    std::string name;
    std::vector<double> frames; // [ms], each until the device has drawn it
    double raysPerSecond = 0;
    double seconds = 0;
};

struct FramesReport {
    std::string device, display, opengl;
    // The parts are frames without a bake, the bake without frames, both while the camera moves, and both
    // while it stands still.
    FramesPart alone, bakeAlone, moving, still;
};

/// Adds up the rays of bakes that follow one another, from what each tells of itself now and then.
class RayCount {
public:
    void see(uint64_t bake, uint64_t raysOfBake) {
        if (bake != bake_) last_ = 0;
        total_ += raysOfBake - last_;
        bake_ = bake;
        last_ = raysOfBake;
    }
    uint64_t total() const { return total_; }

private:
    uint64_t bake_ = 0, last_ = 0, total_ = 0;
};

/// Measures all parts. A bake that comes to its end, as every one does, begins again, so what is measured is
/// always one that goes on. Needs no display. Throws Error.
FramesReport measureFrames(const FramesBenchDesc& desc);

/// Returns the one of a list of times that `share` of them do not exceed; 0 for none.
double percentile(std::vector<double> values, double share);

} // namespace relume
