#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace relume {

/// Threads that wait for loops to share. The caller works too, so a pool of n has n - 1 threads of its own.
/// It is open which thread does what: work must write to places that its index alone decides.
class WorkerPool {
public:
    /// Starts the threads; 0 means one per core, or what the environment variable RELUME_THREADS says.
    explicit WorkerPool(uint32_t threads);
    ~WorkerPool();
    WorkerPool(const WorkerPool&) = delete;
    WorkerPool& operator=(const WorkerPool&) = delete;

    uint32_t size() const { return static_cast<uint32_t>(threads_.size()) + 1; }
    /// Calls work(i) for each i in 0..count - 1, in any order and on any thread, and returns when all are
    /// done. `work` throws nothing. One call at a time.
    void run(uint32_t count, const std::function<void(uint32_t)>& work);

private:
    void serve();
    void share(const std::function<void(uint32_t)>& work, uint32_t count);

    std::mutex mutex_;
    std::condition_variable start_, done_;
    const std::function<void(uint32_t)>* work_ = nullptr;
    uint32_t count_ = 0;
    uint32_t busy_ = 0;  // threads that have not finished this loop
    uint64_t round_ = 0; // counts the loops, to wake each thread once for each
    bool stop_ = false;
    std::atomic<uint32_t> next_{0};
    std::vector<std::thread> threads_;
};

} // namespace relume
