#include "renderer/gl/timer.h"

namespace relume::gl {

Timer::Scope::Scope(Timer& timer, const char* name)
    : timer_(timer), start_(std::chrono::steady_clock::now()) {
    glPushDebugGroup(GL_DEBUG_SOURCE_APPLICATION, 0, -1, name);
    Frame& frame = timer.frames_[timer.current_];
    measured_ = !frame.pending && frame.passes.size() < kMostPasses;
    if (!measured_) return;
    pass_ = frame.passes.size();
    frame.passes.push_back({name, 0.0, 0.0});
    while (frame.queries.size() < 2 * frame.passes.size()) {
        GLuint query = 0;
        glCreateQueries(GL_TIMESTAMP, 1, &query);
        frame.queries.emplace_back(query);
    }
    // These are time stamps, since GL_TIME_ELAPSED cannot nest.
    glQueryCounter(frame.queries[2 * pass_].get(), GL_TIMESTAMP);
}

Timer::Scope::~Scope() {
    if (measured_) {
        Frame& frame = timer_.frames_[timer_.current_];
        glQueryCounter(frame.queries[2 * pass_ + 1].get(), GL_TIMESTAMP);
        const std::chrono::duration<double, std::milli> time = std::chrono::steady_clock::now() - start_;
        frame.passes[pass_].cpuMs = time.count();
    }
    glPopDebugGroup();
}

void Timer::endFrame() {
    Frame& ended = frames_[current_];
    if (!ended.pending && !ended.passes.empty()) {
        ended.pending = true;
        current_ = (current_ + 1) % kFrames;
    }
    for (size_t i = 0; i < kFrames; ++i) { // from the oldest on
        Frame& frame = frames_[(current_ + i) % kFrames];
        if (frame.pending && !collect(frame)) break;
    }
}

// Takes a frame's times. Returns false where the device is not there yet.
bool Timer::collect(Frame& frame) {
    for (size_t i = 0; i < 2 * frame.passes.size(); ++i) {
        GLuint available = GL_FALSE;
        glGetQueryObjectuiv(frame.queries[i].get(), GL_QUERY_RESULT_AVAILABLE, &available);
        if (available == GL_FALSE) return false;
    }
    for (size_t i = 0; i < frame.passes.size(); ++i) {
        GLuint64 start = 0, end = 0; // [ns]
        glGetQueryObjectui64v(frame.queries[2 * i].get(), GL_QUERY_RESULT, &start);
        glGetQueryObjectui64v(frame.queries[2 * i + 1].get(), GL_QUERY_RESULT, &end);
        frame.passes[i].gpuMs = end > start ? static_cast<double>(end - start) * 1e-6 : 0.0;
    }
    passes_ = std::move(frame.passes);
    frame.passes.clear();
    frame.pending = false;
    return true;
}

} // namespace relume::gl
