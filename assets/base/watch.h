#pragma once

namespace relume {

/// Hears how a long job stands, and may end it.
class Watch {
public:
    virtual ~Watch() = default;
    /// Is called every few milliseconds where that can be, on the thread that does the job. `done` is the
    /// share of this phase, negative where it is not known. What it throws ends the job, of which nothing is
    /// left then.
    virtual void hear(const char* phase, double done) = 0;
};

/// Lets the watch hear of all jobs on this thread while it exists; the one before hears of them again
/// afterwards.
class WatchScope {
public:
    explicit WatchScope(Watch& watch);
    ~WatchScope();
    WatchScope(const WatchScope&) = delete;
    WatchScope& operator=(const WatchScope&) = delete;

private:
    Watch* before_;
};

/// Tells this thread's watch, if there is one, how a job stands.
void tellWatch(const char* phase, double done = -1.0);

/// Tells this thread's watch how a loop stands, now and then between its steps.
class WatchedLoop {
public:
    /// Watches a loop; the watch is told at every `often`-th step.
    WatchedLoop(const char* phase, double steps, unsigned often = 1)
        : phase_(phase), steps_(steps), often_(often) {}
    void step() {
        if (++done_ % often_ == 0) tell();
    }

private:
    void tell() const { tellWatch(phase_, steps_ > 0.0 ? static_cast<double>(done_) / steps_ : -1.0); }

    const char* phase_;
    double steps_;
    unsigned often_;
    unsigned long long done_ = 0;
};

} // namespace relume
