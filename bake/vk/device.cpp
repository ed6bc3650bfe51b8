#include "bake/vk/device.h"

#include "assets/base/log.h"
#include "bake/vk/compute_pipelines.h"
#include "bake/vk/device_info.h"
#include "bake/vk/instance.h"
#include "bake/vk/memory_ledger.h"
#include "bake/vk/pipeline_cache.h"
#include "bake/vk/staging.h"

#include <algorithm>
#include <cctype>

namespace relume::vk {

namespace {

std::atomic<uint32_t> messagesOfAll{0};

} // namespace

VKAPI_ATTR VkBool32 VKAPI_CALL onValidationMessage(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                                   VkDebugUtilsMessageTypeFlagsEXT,
                                                   const VkDebugUtilsMessengerCallbackDataEXT* data,
                                                   void* device) {
    static_cast<Device*>(device)->validationMessages_++;
    messagesOfAll++;
    const bool error = (severity & VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT) != 0;
    spdlog::log(error ? spdlog::level::err : spdlog::level::warn, "vulkan: {}", data->pMessage);
    return VK_FALSE;
}

namespace {

int rank(VkPhysicalDeviceType type) {
    switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
        return 4;
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
        return 3;
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
        return 2;
    case VK_PHYSICAL_DEVICE_TYPE_CPU:
        return 1;
    default:
        return 0;
    }
}

std::string lowerCase(std::string text) {
    for (char& c : text)
        c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return text;
}

bool matches(const DeviceInfo& info, const std::string& select) {
    if (select.empty()) return true;
    if (std::all_of(select.begin(), select.end(), [](unsigned char c) { return std::isdigit(c) != 0; }))
        return select == std::to_string(info.index);
    return lowerCase(info.name).find(lowerCase(select)) != std::string::npos;
}

std::string joined(const std::vector<std::string>& words) {
    std::string text;
    for (const std::string& word : words)
        text += (text.empty() ? "" : ", ") + word;
    return text;
}

// A device that can be used comes before one that lacks something, then it is its kind that counts.
int worthOf(const DeviceInfo& info) {
    return (info.missing.empty() ? 10 : 0) + rank(info.type);
}

} // namespace

const DeviceInfo& chooseDevice(const std::vector<DeviceInfo>& infos, const std::string& select, uint32_t turn,
                               std::span<const DeviceUuid> beside) {
    if (infos.empty()) throw Error("no Vulkan device: install mesa-vulkan-drivers or the GPU's driver");
    std::vector<const DeviceInfo*> best;
    for (const DeviceInfo& info : infos) {
        const bool taken = std::find(beside.begin(), beside.end(), info.uuid) != beside.end();
        if (!matches(info, select) || (!beside.empty() && (taken || info.software()))) continue;
        if (!best.empty() && worthOf(info) > worthOf(*best.front())) best.clear();
        if (best.empty() || worthOf(info) == worthOf(*best.front())) best.push_back(&info);
    }
    if (best.empty() && !beside.empty())
        throw Error("there is no second GPU to bake on: 'relume devices' lists what there is");
    if (best.empty()) throw Error("device '" + select + "' not found: 'relume devices' lists them");
    const DeviceInfo& found = *best[turn % best.size()];
    if (!found.missing.empty())
        throw Error("device '" + found.name + "' lacks " + joined(found.missing) +
                    ": choose another one with --device, update its driver or install mesa-vulkan-drivers");
    return found;
}

Device::Device(const Desc& desc) : memoryLimit_(desc.memoryLimit) {
    if (!openLoader()) throw Error("no Vulkan loader found: install libvulkan1");
    try {
        const InstanceDesc instanceDesc{
            .validation = desc.validation, .onMessage = &onValidationMessage, .userData = this};
        const Instance instance = createInstance(instanceDesc);
        if (instance.handle == VK_NULL_HANDLE)
            throw Error("no Vulkan driver: install mesa-vulkan-drivers or the GPU's driver");
        instance_ = instance.handle;
        debugUtils_ = instance.debugUtils;
        volkLoadInstance(instance_);
        if (desc.validation && debugUtils_) {
            const VkDebugUtilsMessengerCreateInfoEXT info = messengerInfo(instanceDesc);
            VK_CHECK(vkCreateDebugUtilsMessengerEXT(instance_, &info, nullptr, &messenger_));
        }
        choose(desc);
        if (desc.chosen) desc.chosen(info_);
        workers_ = std::make_unique<WorkerPool>(0);
        createDevice();
        ledger_ = std::make_unique<MemoryLedger>();
        pipelineCache_ = loadPipelineCache(device_, info_);
        computePipelines_ = std::make_unique<ComputePipelines>();
        staging_ = std::make_unique<Staging>(*this);
    } catch (...) {
        release();
        throw;
    }
}

Device::~Device() {
    release();
}

void Device::keepPipelines() const noexcept {
    if (pipelineCache_ != VK_NULL_HANDLE) savePipelineCache(device_, info_, pipelineCache_);
}

void Device::release() {
    if (device_ != VK_NULL_HANDLE) {
        vkDeviceWaitIdle(device_);
        staging_.reset();
        computePipelines_.reset();
        if (pipelineCache_ != VK_NULL_HANDLE) {
            keepPipelines();
            vkDestroyPipelineCache(device_, pipelineCache_, nullptr);
        }
        vkDestroyDevice(device_, nullptr);
    }
    if (messenger_ != VK_NULL_HANDLE) vkDestroyDebugUtilsMessengerEXT(instance_, messenger_, nullptr);
    if (instance_ != VK_NULL_HANDLE) vkDestroyInstance(instance_, nullptr);
}

void Device::choose(const Desc& desc) {
    const std::vector<VkPhysicalDevice> physicals = physicalDevices(instance_);
    std::vector<DeviceInfo> infos;
    for (VkPhysicalDevice physical : physicals) {
        infos.push_back(readDeviceInfo(physical));
        infos.back().index = static_cast<uint32_t>(infos.size() - 1);
    }
    info_ = chooseDevice(infos, desc.select, desc.turn, desc.beside);
    physical_ = physicals[info_.index];

    const bool accel = info_.rayTracingPipeline || info_.rayQuery;
    VkPhysicalDeviceAccelerationStructurePropertiesKHR accelProperties{
        VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_PROPERTIES_KHR};
    VkPhysicalDeviceRayTracingPipelinePropertiesKHR rayTracing{
        VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_TRACING_PIPELINE_PROPERTIES_KHR};
    VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2};
    if (accel) properties.pNext = &accelProperties;
    if (info_.rayTracingPipeline) accelProperties.pNext = &rayTracing;
    vkGetPhysicalDeviceProperties2(physical_, &properties);
    limits_ = properties.properties.limits;
    rayTracing_ = rayTracing;
    rayTracing_.pNext = nullptr;
    accelScratchAlignment_ = accelProperties.minAccelerationStructureScratchOffsetAlignment;
    vkGetPhysicalDeviceMemoryProperties(physical_, &memory_);
    memoryBudget_ = hasDeviceExtension(physical_, VK_EXT_MEMORY_BUDGET_EXTENSION_NAME);
}

void Device::createDevice() {
    const bool accel = info_.rayTracingPipeline || info_.rayQuery;
    FeatureChain supported(accel, info_.rayTracingPipeline, info_.rayQuery);
    vkGetPhysicalDeviceFeatures2(physical_, &supported.core);
    FeatureChain enabled(accel, info_.rayTracingPipeline, info_.rayQuery);
    enableFeatures(supported, enabled);
    anisotropy_ = enabled.core.features.samplerAnisotropy;

    const auto family = std::find_if(info_.queues.begin(), info_.queues.end(),
                                     [](const QueueFamily& f) { return f.graphics && f.compute; });
    queueFamily_ = static_cast<uint32_t>(family - info_.queues.begin());
    // The last queue is taken, since a viewer in this process may use the first one.
    const std::vector<float> priorities(family->count, 1.0f);
    VkDeviceQueueCreateInfo queue{VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO};
    queue.queueFamilyIndex = queueFamily_;
    queue.queueCount = std::min(family->count, 2u);
    queue.pQueuePriorities = priorities.data();

    const std::vector<const char*> extensions = deviceExtensions(physical_, info_);
    VkDeviceCreateInfo info{VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO};
    info.pNext = &enabled.core;
    info.queueCreateInfoCount = 1;
    info.pQueueCreateInfos = &queue;
    info.enabledExtensionCount = static_cast<uint32_t>(extensions.size());
    info.ppEnabledExtensionNames = extensions.data();
    VK_CHECK(vkCreateDevice(physical_, &info, nullptr, &device_));
    vkGetDeviceQueue(device_, queueFamily_, queue.queueCount - 1, &queue_);
}

uint32_t Device::validationMessagesOfAll() {
    return messagesOfAll;
}

void Device::submit(const VkSubmitInfo& info) const {
    const std::lock_guard lock(queueMutex_);
    VK_CHECK(vkQueueSubmit(queue_, 1, &info, VK_NULL_HANDLE));
}

uint64_t Device::freeMemory() const {
    return std::min(freeDeviceMemory(physical_, memoryBudget_), freeOfLimit());
}

uint64_t Device::usedMemory() const {
    return info_.deviceMemory - std::min(info_.deviceMemory, freeDeviceMemory(physical_, memoryBudget_));
}

uint64_t Device::freeOfLimit() const {
    if (memoryLimit_ == 0) return UINT64_MAX;
    return memoryLimit_ - std::min(memoryLimit_, ledger_->deviceBytes());
}

uint32_t Device::memoryType(uint32_t typeBits, VkMemoryPropertyFlags properties) const {
    for (uint32_t i = 0; i < memory_.memoryTypeCount; ++i)
        if ((typeBits >> i & 1u) != 0 && (memory_.memoryTypes[i].propertyFlags & properties) == properties)
            return i;
    return ~0u;
}

uint32_t Device::deviceMemoryType(uint32_t typeBits) const {
    constexpr VkMemoryPropertyFlags local = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
    constexpr VkMemoryPropertyFlags mappable =
        VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    if (info_.type == VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU) {
        for (uint32_t i = 0; i < memory_.memoryTypeCount; ++i) {
            const VkMemoryPropertyFlags flags = memory_.memoryTypes[i].propertyFlags;
            if ((typeBits >> i & 1u) != 0 && (flags & local) != 0 && (flags & mappable) == 0) return i;
        }
    }
    for (VkMemoryPropertyFlags wanted : {local | mappable | VK_MEMORY_PROPERTY_HOST_CACHED_BIT,
                                         local | mappable, local, VkMemoryPropertyFlags{0}})
        if (const uint32_t type = memoryType(typeBits, wanted); type != ~0u) return type;
    return ~0u;
}

void Device::setName(VkObjectType type, uint64_t handle, const char* name) const {
    if (!debugUtils_ || name == nullptr || name[0] == '\0') return;
    VkDebugUtilsObjectNameInfoEXT info{VK_STRUCTURE_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT};
    info.objectType = type;
    info.objectHandle = handle;
    info.pObjectName = name;
    vkSetDebugUtilsObjectNameEXT(device_, &info);
}

} // namespace relume::vk
