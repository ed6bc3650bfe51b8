#include "assets/base/worker_pool.h"

#include "assets/base/watch.h"

#include <algorithm>
#include <cstdlib>

namespace relume {

uint32_t WorkerPool::defaultSize() {
    if (const char* text = std::getenv("RELUME_THREADS")) {
        const long count = std::strtol(text, nullptr, 10);
        if (count > 0) return static_cast<uint32_t>(std::min(count, 1024L));
    }
    return std::max(1u, std::thread::hardware_concurrency());
}

WorkerPool::WorkerPool(uint32_t threads) {
    const uint32_t own = (threads > 0 ? threads : defaultSize()) - 1;
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

// Takes indices until none is left. After a failure the others are given up.
void WorkerPool::share(Loop& loop) {
    try {
        for (uint32_t i = loop.next++; i < loop.count; i = loop.next++)
            loop.work(i);
    } catch (...) {
        std::lock_guard lock(mutex_);
        if (!loop.failure) loop.failure = std::current_exception();
        loop.next = loop.count;
    }
}

void WorkerPool::serve() {
    std::unique_lock lock(mutex_);
    for (;;) {
        start_.wait(lock, [&] { return stop_ || !open_.empty(); });
        if (stop_) return;
        Loop& loop = *open_.front();
        ++loop.helpers;
        lock.unlock();
        share(loop);
        lock.lock();
        // Nothing is left of it: nobody else needs to look.
        open_.remove(&loop);
        // The caller may return, and the loop end, as soon as the lock is free.
        if (--loop.helpers == 0) loop.left.notify_one();
    }
}

void WorkerPool::run(uint32_t count, const std::function<void(uint32_t)>& work) {
    if (count <= 1 || threads_.empty()) {
        for (uint32_t i = 0; i < count; ++i)
            work(i);
        return;
    }
    Loop loop(work, count);
    {
        std::lock_guard lock(mutex_);
        open_.push_back(&loop);
    }
    start_.notify_all();
    share(loop);
    // A helper may be at its last index still. It waits for nobody but loops that it has begun itself, so
    // that loops within loops come to an end.
    std::unique_lock lock(mutex_);
    open_.remove(&loop);
    loop.left.wait(lock, [&] { return loop.helpers == 0; });
    if (loop.failure) std::rethrow_exception(loop.failure);
}

void runWatched(WorkerPool* pool, const char* phase, uint32_t count,
                const std::function<void(uint32_t)>& work) {
    constexpr uint32_t kEach =
        4; // for each thread: nobody waits long for the last one, and the watch neither
    const uint32_t portion = kEach * (pool ? pool->size() : 1u);
    for (uint32_t first = 0; first < count; first += std::min(portion, count - first)) {
        tellWatch(phase, double(first) / count);
        const uint32_t end = first + std::min(portion, count - first);
        if (pool)
            pool->run(end - first, [&](uint32_t i) { work(first + i); });
        else
            for (uint32_t i = first; i < end; ++i)
                work(i);
    }
}

} // namespace relume
