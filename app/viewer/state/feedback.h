#pragma once

#include <string>

#include "app/viewer/state/log_buffer.h"
#include "app/viewer/window/messages.h"
#include "app/viewer/window/redraw_pacer.h"
#include "assets/base/clock.h"

namespace relume {

/// Answers what the user does: by lines over the scene, by lines on the standard error for --log-actions, and
/// by a window that is drawn anew.
class Feedback {
public:
    explicit Feedback(bool logActions) : start_(Clock::now()), logs_(logActions) {}

    /// Returns the time since the viewer began [s], by which everything in the window goes.
    double now() const { return secondsSince(start_); }

    bool logs() const { return logs_; }
    /// Prints "kind: what" for --log-actions.
    void tell(const char* kind, const std::string& what) const;
    /// Shows a line over the scene; a bad one is told as well.
    void note(const std::string& text, bool bad = false);
    /// Shows a bad line that the log has told already.
    void showError(const std::string& text) { messages_.add(text, true, now()); }
    /// Shows the errors that were logged since the last call: they went wrong beside the main thread. One of
    /// this text is shown elsewhere.
    void followLog(const LogBuffer& log, const std::string& elsewhere = "");
    /// Lets go of the lines that were shown for long enough.
    void expireMessages(double time);
    const Messages& messages() const { return messages_; }

    /// Says that the user changed how the scene looks: its picture is drawn anew, and so is every one after
    /// it until the exposure has followed.
    void sceneChanged() { changed_ = awaited_ = true; }
    /// Tells whether a change waits to be drawn.
    bool sceneIsChanged() const { return changed_; }
    void sceneDrawn() { changed_ = false; }
    /// Follows the automatic exposure: while it adapts, the user waits for it after a change of theirs only.
    void followExposure(bool adapting);
    RedrawPacer& pacer() { return pacer_; }
    const RedrawPacer& pacer() const { return pacer_; }

private:
    Clock::time_point start_;
    bool logs_;
    Messages messages_;
    RedrawPacer pacer_;
    bool changed_ = true;  // the picture is not what the scene looks like
    bool awaited_ = false; // the exposure follows what the user did
    uint64_t logSeen_ = 0; // how many lines of the log were looked at
};

} // namespace relume
