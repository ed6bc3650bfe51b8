#include "app/live/file_watch.h"

#include <chrono>
#include <system_error>

namespace relume {

FileTime fileTime(const std::string& path) {
    std::error_code error;
    const auto time = std::filesystem::last_write_time(path, error);
    return error ? FileTime() : FileTime(time);
}

bool FileWatch::isDue(Clock::time_point now) const {
    return on_ && std::chrono::duration<double>(now - looked_).count() >= kPeriod;
}

bool FileWatch::look(FileTime time, Clock::time_point now) {
    looked_ = now;
    const bool still = time == seen_;
    seen_ = time;
    return time && still && time != known_;
}

} // namespace relume
