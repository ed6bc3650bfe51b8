#pragma once

#include <deque>
#include <vector>

#include "bake/vk/device.h"

namespace relume::vk {

/// One thread's command buffers and a timeline semaphore: record, submit, wait for a value. It is not
/// thread-safe.
class Commands {
public:
    explicit Commands(const Device& device);
    ~Commands(); // waits for what was submitted
    Commands(const Commands&) = delete;
    Commands& operator=(const Commands&) = delete;

    VkCommandBuffer begin();      // a command buffer in the recording state; one at a time
    uint64_t submit();            // ends and submits it; returns the value its completion signals
    void wait(uint64_t value);    // blocks; throws Error on device loss
    bool reached(uint64_t value); // tells it without blocking
    void run() { wait(submit()); }

private:
    void recycle();
    void release();
    const Device& device_;
    VkCommandPool pool_ = VK_NULL_HANDLE;
    VkSemaphore timeline_ = VK_NULL_HANDLE;
    VkCommandBuffer current_ = VK_NULL_HANDLE;
    uint64_t submitted_ = 0;
    struct InFlight {
        VkCommandBuffer buffer;
        uint64_t value;
    };
    std::deque<InFlight> inFlight_;
    std::vector<VkCommandBuffer> free_;
};

/// Makes all earlier shader and transfer writes (and host writes before the submit) visible to later shaders
/// and transfers.
void barrier(VkCommandBuffer cmd);
/// Makes earlier device writes visible to the CPU once the submission has been waited for.
void hostBarrier(VkCommandBuffer cmd);

/// Measures the time between points of a command buffer by GPU timestamps.
class Timestamps {
public:
    Timestamps(const Device& device, uint32_t capacity); // capacity: number of points
    ~Timestamps();
    Timestamps(const Timestamps&) = delete;
    Timestamps& operator=(const Timestamps&) = delete;
    void reset(VkCommandBuffer cmd);
    void mark(VkCommandBuffer cmd, uint32_t point);
    /// Returns the time between two points, once the submission has been waited for; 0 where the queue has no
    /// timestamps.
    double milliseconds(uint32_t from, uint32_t to) const;

private:
    const Device& device_;
    VkQueryPool pool_ = VK_NULL_HANDLE;
    uint32_t capacity_ = 0;
    uint64_t mask_ = 0; // the queue's valid timestamp bits
};

} // namespace relume::vk
