#pragma once

#include <string>
#include <vector>

namespace relume {

/// The lines that are shown over the scene for some seconds. The caller gives all times [s].
class Messages {
public:
    struct Message {
        std::string text;
        bool bad = false;
        double until = 0;
    };
    /// Shows a text; where the same text is shown already, it stays longer.
    void add(const std::string& text, bool bad, double now);
    void expire(double now);
    void clear() { shown_.clear(); }
    const std::vector<Message>& shown() const { return shown_; }
    /// Returns when the next message goes, or `never` where there is none.
    double nextExpiry(double never) const;

private:
    std::vector<Message> shown_;
};

} // namespace relume
