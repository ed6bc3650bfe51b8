#pragma once

#include <string>
#include <vector>

namespace relume {

/// Lines shown over the scene for some seconds. All times [s] are the caller's.
class Messages {
public:
    struct Message {
        std::string text;
        bool bad = false;
        double until = 0;
    };
    /// The same text, shown already, stays longer.
    void add(const std::string& text, bool bad, double now);
    void expire(double now);
    void clear() { shown_.clear(); }
    const std::vector<Message>& shown() const { return shown_; }
    /// When the next one goes; `never` without any.
    double nextExpiry(double never) const;

private:
    std::vector<Message> shown_;
};

} // namespace relume
