#include "app/viewer/state/log_buffer.h"

#include <algorithm>

#include <spdlog/sinks/base_sink.h>

namespace relume {

class LogBuffer::Sink final : public spdlog::sinks::base_sink<std::mutex> {
public:
    explicit Sink(LogBuffer& buffer) : buffer_(buffer) {}

protected:
    void sink_it_(const spdlog::details::log_msg& message) override {
        buffer_.add({message.level, {message.payload.data(), message.payload.size()}});
    }
    void flush_() override {}

private:
    LogBuffer& buffer_;
};

LogBuffer::LogBuffer() : sink_(std::make_shared<Sink>(*this)) {
    spdlog::default_logger()->sinks().push_back(sink_);
}

LogBuffer::~LogBuffer() {
    std::erase(spdlog::default_logger()->sinks(), std::shared_ptr<spdlog::sinks::sink>(sink_));
}

void LogBuffer::add(LogLine line) {
    const std::lock_guard lock(mutex_);
    lines_.push_back(std::move(line));
    if (lines_.size() > kMostLines) lines_.pop_front();
    ++count_;
}

uint64_t LogBuffer::count() const {
    const std::lock_guard lock(mutex_);
    return count_;
}

std::vector<LogLine> LogBuffer::lines() const {
    const std::lock_guard lock(mutex_);
    return {lines_.begin(), lines_.end()};
}

std::vector<LogLine> LogBuffer::linesSince(uint64_t since) const {
    const std::lock_guard lock(mutex_);
    const auto fresh = static_cast<ptrdiff_t>(std::min<uint64_t>(count_ - since, lines_.size()));
    return {lines_.end() - fresh, lines_.end()};
}

} // namespace relume
