#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include <volk.h>

#include "assets/base/error.h"
#include "assets/base/worker_pool.h"

namespace relume::vk {

/// Returns the name of a result: "VK_ERROR_DEVICE_LOST" and so on.
const char* resultName(VkResult result);
/// Throws Error naming the call and the VkResult where that is a failure; release builds check it, too.
void check(VkResult result, const char* call);
#define VK_CHECK(call) ::relume::vk::check((call), #call)

struct QueueFamily {
    uint32_t count = 0;
    bool graphics = false, compute = false, transfer = false;
};

/// The properties of a device that `relume devices` prints and that the choice of a tracer rests on.
struct DeviceInfo {
    uint32_t index = 0; // in vkEnumeratePhysicalDevices' order
    std::string name, driver;
    uint32_t apiVersion = 0, driverVersion = 0;
    VkPhysicalDeviceType type = VK_PHYSICAL_DEVICE_TYPE_OTHER;
    std::array<uint8_t, VK_UUID_SIZE> uuid{}; // the same in every interface of a driver
    uint64_t deviceMemory = 0;                // [bytes], largest device-local heap
    uint64_t freeMemory = 0;                  // [bytes], by VK_EXT_memory_budget, else deviceMemory
    std::vector<QueueFamily> queues;
    std::vector<std::string> missing; // what Relume needs and this device lacks; empty: usable
    bool rayTracingPipeline = false;
    bool rayQuery = false;
    bool fragmentStores = false;      // fragmentStoresAndAtomics
    bool externalMemory = false;      // VK_KHR_external_memory_fd
    VkDeviceSize importAlignment = 0; // of memory of the host that becomes the device's [bytes]; 0: cannot
    bool software() const { return type == VK_PHYSICAL_DEVICE_TYPE_CPU; }
    /// Drivers emulate the pipeline on GPUs without RT cores but offer ray queries only where there are some.
    bool rayTracingCores() const { return !software() && rayTracingPipeline && rayQuery; }
    bool integrated() const { return type == VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU; }
    /// Tells whether its memory is the host's.
    bool sharesMemory() const { return software() || integrated(); }
};

/// Returns "discrete", "integrated", "virtual", "software" or "other".
const char* deviceTypeName(VkPhysicalDeviceType type);

using DeviceUuid = std::array<uint8_t, VK_UUID_SIZE>;

/// Returns the one of these devices that Device takes (Device::Desc::select, turn and beside). Throws Error
/// where there is none, and where it lacks something.
const DeviceInfo& chooseDevice(const std::vector<DeviceInfo>& infos, const std::string& select, uint32_t turn,
                               std::span<const DeviceUuid> beside = {});

/// Returns all Vulkan devices of this machine; the list is empty without a loader or driver.
std::vector<DeviceInfo> listDevices();

class ComputePipelines;
class MemoryLedger;
class Staging;

/// An instance, a device and one queue with graphics and compute. It outlives everything made from it.
class Device {
public:
    struct Desc {
        std::string select; // "": best by capability (discrete > integrated > software); else index or part
                            // of the name
        // Of several devices that are as good as the best one, the one that has this number among them,
        // counted round and round: each process of a machine takes another one.
        uint32_t turn = 0;
        // These GPUs have other work: where there are some, one that is none of them is taken.
        std::vector<DeviceUuid> beside = {};
        bool validation =
            false; // Khronos validation with synchronization validation; messages are counted and logged
        // No more of the device's memory is taken than this [bytes]; 0: all that is free.
        uint64_t memoryLimit = 0;
        // Called before the logical device and its pool of threads are made: these threads, and those of a
        // software driver, inherit the priority that the calling thread has then.
        std::function<void(const DeviceInfo&)> chosen = {};
    };
    /// Throws Error where there is no loader, no driver or no such device, and names what a device lacks.
    /// Devices alive at one time must agree on `validation`, and none may be in use on another thread: the
    /// function pointers are per process.
    explicit Device(const Desc& desc);
    ~Device();
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;

    VkInstance instance() const { return instance_; }
    VkPhysicalDevice physical() const { return physical_; }
    VkDevice handle() const { return device_; }
    VkQueue queue() const { return queue_; }
    uint32_t queueFamily() const { return queueFamily_; }
    const DeviceInfo& info() const { return info_; }
    const VkPhysicalDeviceLimits& limits() const { return limits_; }
    /// Calls vkQueueSubmit; any thread may call this.
    void submit(const VkSubmitInfo& info) const;
    /// Returns the properties of the ray tracing pipeline, all zero where the device has none.
    const VkPhysicalDeviceRayTracingPipelinePropertiesKHR& rayTracing() const { return rayTracing_; }
    bool anisotropy() const { return anisotropy_; } // samplers may filter anisotropically
    uint32_t accelScratchAlignment() const { return accelScratchAlignment_; }
    /// Returns the device-local memory that is free now, and within the limit [bytes].
    uint64_t freeMemory() const;
    /// Returns the device-local memory that is in use now, whoever uses it [bytes].
    uint64_t usedMemory() const;
    bool limited() const { return memoryLimit_ > 0; } // its user wants no more of its memory taken
    /// Returns what the limit leaves now [bytes], the most there is where there is none.
    uint64_t freeOfLimit() const;
    /// Returns the index of a memory type with these properties among `typeBits`; ~0u if there is none.
    uint32_t memoryType(uint32_t typeBits, VkMemoryPropertyFlags properties) const;
    /// Returns the memory type for Memory::Device: on a discrete GPU not the one the CPU sees too (a small
    /// window into it), on others one that the CPU can map where there is one; ~0u if there is none.
    uint32_t deviceMemoryType(uint32_t typeBits) const;
    VkDeviceSize heapSize(uint32_t memoryType) const {
        return memory_.memoryHeaps[memory_.memoryTypes[memoryType].heapIndex].size;
    }
    VkMemoryPropertyFlags memoryProperties(uint32_t type) const {
        return memory_.memoryTypes[type].propertyFlags;
    }
    void setName(VkObjectType type, uint64_t handle, const char* name) const; // no-op without debug utils
    /// Returns how many validation warnings and errors have been seen so far.
    uint32_t validationMessages() const { return validationMessages_; }
    /// Returns the same number for all devices of this process, those destroyed as well.
    static uint32_t validationMessagesOfAll();
    VkPipelineCache pipelineCache() const { return pipelineCache_; }
    /// Writes what was compiled so far for later runs, which the destructor does as well: a process that
    /// lives long may be killed. Any thread may call it.
    void keepPipelines() const noexcept;
    ComputePipelines& computePipelines() const { return *computePipelines_; }
    Staging& staging() const { return *staging_; }
    /// Returns the pool for the CPU's share of all work on this device: nobody makes threads of his own.
    WorkerPool& workers() const { return *workers_; }
    MemoryLedger& ledger() const { return *ledger_; } // of all memory that is allocated on it

private:
    friend VKAPI_ATTR VkBool32 VKAPI_CALL onValidationMessage(VkDebugUtilsMessageSeverityFlagBitsEXT,
                                                              VkDebugUtilsMessageTypeFlagsEXT,
                                                              const VkDebugUtilsMessengerCallbackDataEXT*,
                                                              void*);
    void choose(const Desc& desc);
    void createDevice();
    void release();

    VkInstance instance_ = VK_NULL_HANDLE;
    VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
    VkPhysicalDevice physical_ = VK_NULL_HANDLE;
    VkDevice device_ = VK_NULL_HANDLE;
    VkQueue queue_ = VK_NULL_HANDLE;
    uint32_t queueFamily_ = 0;
    DeviceInfo info_;
    VkPhysicalDeviceLimits limits_{};
    VkPhysicalDeviceMemoryProperties memory_{};
    VkPhysicalDeviceRayTracingPipelinePropertiesKHR rayTracing_{};
    uint32_t accelScratchAlignment_ = 0;
    uint64_t memoryLimit_ = 0;
    bool memoryBudget_ = false;
    bool debugUtils_ = false;
    bool anisotropy_ = false;
    mutable std::mutex queueMutex_;
    VkPipelineCache pipelineCache_ = VK_NULL_HANDLE;
    std::unique_ptr<ComputePipelines> computePipelines_;
    std::unique_ptr<WorkerPool> workers_;
    std::unique_ptr<MemoryLedger> ledger_;
    std::unique_ptr<Staging> staging_;
    std::atomic<uint32_t> validationMessages_{0};
};

} // namespace relume::vk
