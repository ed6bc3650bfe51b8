#pragma once

#include <array>
#include <chrono>
#include <string>
#include <vector>

#include "renderer/gl/handle.h"

namespace relume::gl {

inline void deleteQuery(GLuint name) {
    glDeleteQueries(1, &name);
}

/// Measures how long named passes of a frame take on the device and on the host. Device times arrive some
/// frames later; nothing ever waits for them.
class Timer {
public:
    /// A frame measures no more passes than this, so that one that nobody ends costs nothing.
    static constexpr size_t kMostPasses = 256;

    struct Pass {
        std::string name;
        double gpuMs = 0, cpuMs = 0;
    };
    /// Measures a pass, and names its commands for captures, while it lives; passes may nest.
    class Scope {
    public:
        Scope(Timer& timer, const char* name);
        ~Scope();
        Scope(const Scope&) = delete;
        Scope& operator=(const Scope&) = delete;

    private:
        Timer& timer_;
        size_t pass_ = 0;
        bool measured_ = false;
        std::chrono::steady_clock::time_point start_;
    };

    /// Ends a frame, outside of all passes: what is measured from now on belongs to the next.
    void endFrame();
    /// Returns the passes, in the order of their starts, of the newest frame whose device times are known.
    const std::vector<Pass>& passes() const { return passes_; }

private:
    // A device that is more frames behind is not measured.
    static constexpr size_t kFrames = 8;
    struct Frame {
        std::vector<Pass> passes;
        std::vector<Handle<deleteQuery>> queries; // start and end of each pass; kept for later frames
        bool pending = false;
    };

    bool collect(Frame& frame);

    std::array<Frame, kFrames> frames_;
    size_t current_ = 0; // being measured; the next ones in the ring are the oldest
    std::vector<Pass> passes_;
};

} // namespace relume::gl
