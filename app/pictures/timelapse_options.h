#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "app/pictures/shot_options.h"

namespace relume {

/// The options that the user typed after `relume timelapse`.
struct TimelapseOptions {
    ShotOptions shot; // all but its lightmap
    std::string at;   // "": not given
    double fps = 0;   // 0: not given
    bool noCaption = false, overwrite = false;
};

void addTimelapseOptions(CLI::App& command, TimelapseOptions& options);

/// The series that the options ask for. resolveTimelapseOptions() throws UsageError when they are wrong or
/// contradict each other.
struct TimelapseRequest {
    ShotRequest shot;
    std::vector<uint32_t>
        at;           // passes or directions per patch, rising; empty: twice as many from frame to frame
    double every = 0; // a frame each so many seconds of the solver, instead; 0: by `at`
    double rate = 2;  // of a video [frames/s]
    bool caption = true;
};
TimelapseRequest resolveTimelapseOptions(const TimelapseOptions& options);

} // namespace relume
