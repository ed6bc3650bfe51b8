#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace relume {

/// The cost of drawing, which the profiler shows.
struct FrameFigures {
    static constexpr size_t kKept = 240; // frames

    struct Span {
        std::string name;
        double cpu = 0;  // [ms], of the last time it ran
        double gpu = -1; // [ms], negative: not measured
    };
    std::vector<Span> spans;
    std::array<float, kKept> frames{}; // [ms], a ring of the newest
    size_t next = 0;
    double total = 0;      // [ms] of the last frame
    uint64_t drawn = 0;    // frames with a new picture of the scene
    uint64_t repeated = 0; // frames that showed the last one again
    uint32_t drawCalls = 0, culled = 0;

    void addFrame(double milliseconds) {
        total = milliseconds;
        frames[next] = static_cast<float>(milliseconds);
        next = (next + 1) % kKept;
    }
    Span& span(const std::string& name) {
        for (Span& known : spans)
            if (known.name == name) return known;
        spans.push_back({name});
        return spans.back();
    }
};

} // namespace relume
