#include "app/viewer/state/feedback.h"

#include <cstdio>

namespace relume {

void Feedback::tell(const char* kind, const std::string& what) const {
    if (logs_) std::fprintf(stderr, "%s: %s\n", kind, what.c_str());
}

void Feedback::note(const std::string& text, bool bad) {
    tell(bad ? "error" : "note", text);
    messages_.add(text, bad, now());
    pacer_.input();
}

void Feedback::followLog(const LogBuffer& log, const std::string& elsewhere) {
    const uint64_t count = log.count();
    if (count == logSeen_) return;
    const std::vector<LogLine> lines = log.linesSince(logSeen_);
    logSeen_ = count;
    for (const LogLine& line : lines)
        if (line.level >= spdlog::level::err && line.text != elsewhere) showError(line.text);
    pacer_.input();
}

void Feedback::expireMessages(double time) {
    const bool shown = !messages_.shown().empty();
    messages_.expire(time);
    if (shown && messages_.shown().empty()) pacer_.input();
}

void Feedback::followExposure(bool adapting) {
    if (!adapting)
        awaited_ = false;
    else if (awaited_)
        pacer_.sceneChanged();
    else
        pacer_.newMap();
}

} // namespace relume
