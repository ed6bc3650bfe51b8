#pragma once

#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "assets/base/log.h"

namespace relume {

struct LogLine {
    spdlog::level::level_enum level = spdlog::level::info;
    std::string text;
};

/// The newest lines of the log, for a panel; what is logged goes to stderr as well. Any thread may use it.
class LogBuffer {
public:
    static constexpr size_t kMostLines = 2000;

    /// Takes lines from now on until it is destroyed. Both must not happen while other threads log.
    LogBuffer();
    ~LogBuffer();
    LogBuffer(const LogBuffer&) = delete;
    LogBuffer& operator=(const LogBuffer&) = delete;

    /// Returns how many lines were ever added, to see whether there are new ones.
    uint64_t count() const;
    std::vector<LogLine> lines() const;
    /// Returns the lines since count() was `since`, as far as they are still there.
    std::vector<LogLine> linesSince(uint64_t since) const;

private:
    class Sink;
    void add(LogLine line);

    mutable std::mutex mutex_;
    std::deque<LogLine> lines_;
    uint64_t count_ = 0;
    std::shared_ptr<Sink> sink_; // shared: that is how spdlog keeps sinks
};

} // namespace relume
