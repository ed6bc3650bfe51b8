#pragma once

namespace relume {

/// While one exists, Ctrl-C (SIGINT) and SIGTERM only set a flag, so that a long job can stop between two
/// batches and clean up. A second Ctrl-C ends the program at once.
class InterruptGuard {
public:
    InterruptGuard();
    ~InterruptGuard();
    InterruptGuard(const InterruptGuard&) = delete;
    InterruptGuard& operator=(const InterruptGuard&) = delete;
    static bool requested();
};

} // namespace relume
