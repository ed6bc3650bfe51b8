#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <functional>
#include <list>
#include <mutex>
#include <thread>
#include <vector>

namespace relume {

/// Threads that wait for loops to share. The caller works too, so a pool of n has n - 1 threads of its own.
/// It is open which thread does what: work must write to places that its index alone decides. Threads may
/// share loops at the same time, and work may share a loop of its own.
class WorkerPool {
public:
    /// Starts the threads, which inherit the caller's priority; 0 means one per core, or what the environment
    /// variable RELUME_THREADS says.
    explicit WorkerPool(uint32_t threads);
    ~WorkerPool();
    WorkerPool(const WorkerPool&) = delete;
    WorkerPool& operator=(const WorkerPool&) = delete;

    /// Returns how many threads a pool of 0 has. Libraries that bring threads of their own get as many.
    static uint32_t defaultSize();

    uint32_t size() const { return static_cast<uint32_t>(threads_.size()) + 1; }
    /// Calls work(i) for each i in 0..count - 1, in any order and on any thread, and returns when all are
    /// done. Throws the first thing that work threw; then not every index may have come.
    void run(uint32_t count, const std::function<void(uint32_t)>& work);

private:
    /// One call of run(), as long as it lasts.
    struct Loop {
        Loop(const std::function<void(uint32_t)>& loopWork, uint32_t loopCount)
            : work(loopWork), count(loopCount) {}
        const std::function<void(uint32_t)>& work;
        const uint32_t count;
        std::atomic<uint32_t> next{0};
        uint32_t helpers = 0;            // threads of the pool that are at it
        std::exception_ptr failure = {}; // what was thrown first
        std::condition_variable left;    // the last helper has
    };
    void serve();
    void share(Loop& loop);

    std::mutex mutex_;
    std::condition_variable start_;
    std::list<Loop*> open_; // loops that may have work left, the oldest first
    bool stop_ = false;
    std::vector<std::thread> threads_;
};

/// Does as pool->run() does; nullptr: on this thread alone. Between portions this thread's watch hears how
/// far the loop is, and what it throws ends the loop.
void runWatched(WorkerPool* pool, const char* phase, uint32_t count,
                const std::function<void(uint32_t)>& work);

} // namespace relume
