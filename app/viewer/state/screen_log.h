#pragma once

#include <string>

#include <glm/glm.hpp>

#include "app/live/lightmap_exchange.h"
#include "app/viewer/state/feedback.h"

namespace relume {

/// Tells --log-actions what the window shows, each time that it is something else.
class ScreenLog {
public:
    explicit ScreenLog(const Feedback& feedback) : feedback_(feedback) {}

    void tellWindow(const glm::uvec2& size, bool minimised);
    void tellMap(const PublishedMap& map);
    /// Tells what stands in the middle of the window. Returns whether that is something else than before.
    bool tellMiddle(const std::string& name);
    /// Says that so many inputs were taken: what is on the screen may have to settle again.
    void countInputs(size_t count);
    /// Tells once that what was asked for is on the screen, with the number of inputs taken so far.
    void tellSettled(bool settled);

private:
    const Feedback& feedback_;
    std::string map_;    // what was said of the newest one
    std::string middle_; // what was said of the middle of the window
    glm::uvec2 size_{0}; // of the window
    bool minimised_ = false, settled_ = false;
    uint64_t inputs_ = 0;
};

} // namespace relume
