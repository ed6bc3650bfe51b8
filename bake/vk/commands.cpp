#include "bake/vk/commands.h"

#include <utility>

namespace relume::vk {

Commands::Commands(const Device& device) : device_(device) {
    try {
        VkCommandPoolCreateInfo pool{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
        pool.flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT;
        pool.queueFamilyIndex = device.queueFamily();
        VK_CHECK(vkCreateCommandPool(device.handle(), &pool, nullptr, &pool_));
        VkSemaphoreTypeCreateInfo type{VK_STRUCTURE_TYPE_SEMAPHORE_TYPE_CREATE_INFO};
        type.semaphoreType = VK_SEMAPHORE_TYPE_TIMELINE;
        const VkSemaphoreCreateInfo semaphore{VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO, &type};
        VK_CHECK(vkCreateSemaphore(device.handle(), &semaphore, nullptr, &timeline_));
    } catch (...) {
        release();
        throw;
    }
}

Commands::~Commands() {
    if (submitted_ > 0) {
        VkSemaphoreWaitInfo info{VK_STRUCTURE_TYPE_SEMAPHORE_WAIT_INFO};
        info.semaphoreCount = 1;
        info.pSemaphores = &timeline_;
        info.pValues = &submitted_;
        vkWaitSemaphores(device_.handle(), &info, UINT64_MAX); // a lost device answers at once
    }
    release();
}

void Commands::release() {
    vkDestroySemaphore(device_.handle(), timeline_, nullptr);
    vkDestroyCommandPool(device_.handle(), pool_, nullptr);
}

void Commands::recycle() {
    uint64_t done = 0;
    VK_CHECK(vkGetSemaphoreCounterValue(device_.handle(), timeline_, &done));
    while (!inFlight_.empty() && inFlight_.front().value <= done) {
        free_.push_back(inFlight_.front().buffer);
        inFlight_.pop_front();
    }
}

VkCommandBuffer Commands::begin() {
    ASSERT(current_ == VK_NULL_HANDLE);
    recycle();
    if (free_.empty()) {
        VkCommandBufferAllocateInfo info{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
        info.commandPool = pool_;
        info.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
        info.commandBufferCount = 1;
        VkCommandBuffer buffer = VK_NULL_HANDLE;
        VK_CHECK(vkAllocateCommandBuffers(device_.handle(), &info, &buffer));
        free_.push_back(buffer);
    }
    VkCommandBufferBeginInfo info{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    info.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
    VK_CHECK(vkBeginCommandBuffer(free_.back(), &info));
    current_ = free_.back();
    free_.pop_back();
    return current_;
}

uint64_t Commands::submit() {
    ASSERT(current_ != VK_NULL_HANDLE);
    const VkCommandBuffer buffer = std::exchange(current_, VK_NULL_HANDLE);
    VK_CHECK(vkEndCommandBuffer(buffer));
    const uint64_t value = submitted_ + 1;
    VkTimelineSemaphoreSubmitInfo timeline{VK_STRUCTURE_TYPE_TIMELINE_SEMAPHORE_SUBMIT_INFO};
    timeline.signalSemaphoreValueCount = 1;
    timeline.pSignalSemaphoreValues = &value;
    VkSubmitInfo info{VK_STRUCTURE_TYPE_SUBMIT_INFO, &timeline};
    info.commandBufferCount = 1;
    info.pCommandBuffers = &buffer;
    info.signalSemaphoreCount = 1;
    info.pSignalSemaphores = &timeline_;
    device_.submit(info);
    submitted_ = value;
    inFlight_.push_back({buffer, value});
    return value;
}

void Commands::wait(uint64_t value) {
    VkSemaphoreWaitInfo info{VK_STRUCTURE_TYPE_SEMAPHORE_WAIT_INFO};
    info.semaphoreCount = 1;
    info.pSemaphores = &timeline_;
    info.pValues = &value;
    VK_CHECK(vkWaitSemaphores(device_.handle(), &info, UINT64_MAX));
}

bool Commands::reached(uint64_t value) {
    uint64_t done = 0;
    VK_CHECK(vkGetSemaphoreCounterValue(device_.handle(), timeline_, &done));
    return done >= value;
}

// All stages stand on both sides: the passes are few and long, and one queue runs them one after the other
// anyway.
void barrier(VkCommandBuffer cmd) {
    VkMemoryBarrier memory{VK_STRUCTURE_TYPE_MEMORY_BARRIER};
    memory.srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT;
    memory.dstAccessMask = VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT;
    vkCmdPipelineBarrier(cmd, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT | VK_PIPELINE_STAGE_HOST_BIT,
                         VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 1, &memory, 0, nullptr, 0, nullptr);
}

void hostBarrier(VkCommandBuffer cmd) {
    VkMemoryBarrier memory{VK_STRUCTURE_TYPE_MEMORY_BARRIER};
    memory.srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT;
    memory.dstAccessMask = VK_ACCESS_HOST_READ_BIT | VK_ACCESS_HOST_WRITE_BIT;
    vkCmdPipelineBarrier(cmd, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_PIPELINE_STAGE_HOST_BIT, 0, 1, &memory,
                         0, nullptr, 0, nullptr);
}

Timestamps::Timestamps(const Device& device, uint32_t capacity) : device_(device) {
    uint32_t count = 0;
    vkGetPhysicalDeviceQueueFamilyProperties(device.physical(), &count, nullptr);
    std::vector<VkQueueFamilyProperties> families(count);
    vkGetPhysicalDeviceQueueFamilyProperties(device.physical(), &count, families.data());
    const uint32_t bits = families[device.queueFamily()].timestampValidBits;
    mask_ = bits == 0 ? 0 : ~uint64_t{0} >> (64 - bits);
    VkQueryPoolCreateInfo info{VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO};
    info.queryType = VK_QUERY_TYPE_TIMESTAMP;
    info.queryCount = capacity;
    VK_CHECK(vkCreateQueryPool(device.handle(), &info, nullptr, &pool_));
    vkResetQueryPool(device.handle(), pool_, 0, capacity);
    capacity_ = capacity;
}

Timestamps::~Timestamps() {
    vkDestroyQueryPool(device_.handle(), pool_, nullptr);
}

void Timestamps::reset(VkCommandBuffer cmd) {
    vkCmdResetQueryPool(cmd, pool_, 0, capacity_);
}

void Timestamps::mark(VkCommandBuffer cmd, uint32_t point) {
    ASSERT(point < capacity_);
    if (mask_ != 0) vkCmdWriteTimestamp(cmd, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, pool_, point);
}

double Timestamps::milliseconds(uint32_t from, uint32_t to) const {
    if (mask_ == 0) return 0.0;
    uint64_t ticks[2] = {};
    const uint32_t points[2] = {from, to};
    for (int i = 0; i < 2; ++i)
        VK_CHECK(vkGetQueryPoolResults(device_.handle(), pool_, points[i], 1, sizeof(uint64_t), &ticks[i],
                                       sizeof(uint64_t), VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT));
    const uint64_t difference = ((ticks[1] & mask_) - (ticks[0] & mask_)) & mask_; // counters wrap
    return static_cast<double>(difference) * static_cast<double>(device_.limits().timestampPeriod) * 1e-6;
}

} // namespace relume::vk
