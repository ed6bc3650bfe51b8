#include "app/viewer/window/messages.h"

#include <algorithm>

namespace relume {
namespace {

constexpr double kNoteSeconds = 4, kBadSeconds = 10; // a message of what went wrong takes longer to read
constexpr size_t kMostMessages = 4;                  // at once

} // namespace

void Messages::add(const std::string& text, bool bad, double now) {
    std::erase_if(shown_, [&](const Message& message) { return message.text == text; });
    shown_.push_back({text, bad, now + (bad ? kBadSeconds : kNoteSeconds)});
    if (shown_.size() > kMostMessages) shown_.erase(shown_.begin());
}

void Messages::expire(double now) {
    std::erase_if(shown_, [&](const Message& message) { return message.until <= now; });
}

double Messages::nextExpiry(double never) const {
    for (const Message& message : shown_)
        never = std::min(never, message.until);
    return never;
}

} // namespace relume
