#include "bake/base/worker_pool.h"

#include <algorithm>
#include <cstdlib>

namespace relume {

namespace {

uint32_t defaultThreads() {
    if (const char* text = std::getenv("RELUME_THREADS")) {
        const long count = std::strtol(text, nullptr, 10);
        if (count > 0) return static_cast<uint32_t>(std::min(count, 1024L));
    }
    return std::max(1u, std::thread::hardware_concurrency());
}

} // namespace

WorkerPool::WorkerPool(uint32_t threads) {
    const uint32_t own = (threads > 0 ? threads : defaultThreads()) - 1;
    for (uint32_t i = 0; i < own; ++i)
        threads_.emplace_back([this] { serve(); });
}

WorkerPool::~WorkerPool() {
    {
        std::lock_guard lock(mutex_);
        stop_ = true;
    }
    start_.notify_all();
    for (std::thread& thread : threads_)
        thread.join();
}

void WorkerPool::share(const std::function<void(uint32_t)>& work, uint32_t count) {
    for (uint32_t i = next_++; i < count; i = next_++)
        work(i);
}

void WorkerPool::serve() {
    uint64_t seen = 0;
    std::unique_lock lock(mutex_);
    for (;;) {
        start_.wait(lock, [&] { return stop_ || round_ != seen; });
        if (stop_) return;
        seen = round_;
        const std::function<void(uint32_t)>& work = *work_;
        const uint32_t count = count_;
        lock.unlock();
        share(work, count);
        lock.lock();
        if (--busy_ == 0) done_.notify_one();
    }
}

void WorkerPool::run(uint32_t count, const std::function<void(uint32_t)>& work) {
    if (count <= 1 || threads_.empty()) {
        for (uint32_t i = 0; i < count; ++i)
            work(i);
        return;
    }
    {
        std::lock_guard lock(mutex_);
        work_ = &work;
        count_ = count;
        busy_ = static_cast<uint32_t>(threads_.size());
        next_ = 0;
        ++round_;
    }
    start_.notify_all();
    share(work, count);
    // Every thread reports, even one that found nothing left: none may still hold `work` when this returns.
    std::unique_lock lock(mutex_);
    done_.wait(lock, [&] { return busy_ == 0; });
}

} // namespace relume
