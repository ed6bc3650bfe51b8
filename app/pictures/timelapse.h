#pragma once

#include "app/offline/solve_watcher.h"
#include "app/pictures/frame_writer.h"
#include "app/pictures/picture_studio.h"
#include "app/pictures/timelapse_options.h"

namespace relume {

/// Takes pictures of a bake on its way. All of a series have the exposure of its end, so that it does not
/// flicker: where that must be measured, lightmaps wait for it in memory.
class Timelapse final : public SolveWatcher {
public:
    /// All that a time lapse needs. The references must outlive it.
    struct Desc {
        PictureStudio& studio;
        Baker& baker;
        FrameWriter& writer;
        const TimelapseRequest& request;
        LightmapDesc lightmap;
        std::string title; // of the caption
        bool pairs = true; // passes are counted, else directions per patch
    };
    explicit Timelapse(const Desc& desc);

    void afterStep(Solver& solver) override;
    /// Writes the frames first where they go to a folder.
    [[noreturn]] void interrupt(Solver& solver) override;
    /// Writes the last frame, and all that waited for it. Throws Error.
    void finish();

private:
    struct Frame {
        uint32_t times = 1;
        std::vector<std::string> caption;
    };
    /// Light that is not drawn yet, and the frames that show it.
    struct Moment {
        uint32_t count = 0; // of passes or directions
        FloatImage lightmap;
        std::vector<Frame> frames;
    };
    uint32_t countNow() const;
    uint32_t framesDue();
    void add(uint32_t times);
    void keepLight();
    std::vector<std::string> caption() const;
    void flush(size_t kept);
    void write(const Moment& moment);

    Desc desc_;
    DrawSettings draw_;
    std::vector<Moment> moments_;
    size_t nextAt_ = 0;      // in request.at
    uint32_t nextCount_ = 1; // of a series of its own
    double nextSeconds_;     // of the solver
};

} // namespace relume
