#include "assets/base/watch.h"

#include <utility>

namespace relume {
namespace {

thread_local Watch* watchOfThread = nullptr;

} // namespace

WatchScope::WatchScope(Watch& watch) : before_(std::exchange(watchOfThread, &watch)) {}

WatchScope::~WatchScope() {
    watchOfThread = before_;
}

void tellWatch(const char* phase, double done) {
    if (watchOfThread) watchOfThread->hear(phase, done);
}

} // namespace relume
