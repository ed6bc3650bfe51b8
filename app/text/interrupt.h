#pragma once

namespace relume {

/// While one exists, Ctrl-C (SIGINT), SIGTERM and SIGUSR1 only set a flag, so that a long job can stop
/// between two batches and clean up. A second Ctrl-C ends the program at once. mpirun passes SIGUSR1 on to
/// its processes without killing them soon after, and Slurm sends it ahead of a time limit
/// (--signal=USR1@60).
class InterruptGuard {
public:
    InterruptGuard();
    ~InterruptGuard();
    InterruptGuard(const InterruptGuard&) = delete;
    InterruptGuard& operator=(const InterruptGuard&) = delete;
    static bool requested();
};

/// Throws Error when Ctrl-C was pressed while an InterruptGuard exists.
void stopIfInterrupted();

/// While one exists, beside an InterruptGuard, no file is being written and no work is worth being saved:
/// what has not stopped by itself 0.35 s after Ctrl-C, because a library or a driver does not come back, is
/// ended as an interrupted job is, with the same message and exit status.
class Abandonable {
public:
    Abandonable();
    ~Abandonable();
    Abandonable(const Abandonable&) = delete;
    Abandonable& operator=(const Abandonable&) = delete;
};

} // namespace relume
