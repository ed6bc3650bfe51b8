#include "bake/vk/device_info.h"

#include "bake/vk/instance.h"

#include <algorithm>
#include <cstring>

namespace relume::vk {

namespace {

struct Need {
    VkBool32 VkPhysicalDeviceVulkan12Features::*feature;
    const char* name;
};
constexpr Need kNeeds[] = {
    {&VkPhysicalDeviceVulkan12Features::bufferDeviceAddress, "bufferDeviceAddress"},
    {&VkPhysicalDeviceVulkan12Features::scalarBlockLayout, "scalarBlockLayout"},
    {&VkPhysicalDeviceVulkan12Features::timelineSemaphore, "timelineSemaphore"},
    {&VkPhysicalDeviceVulkan12Features::storageBuffer8BitAccess, "storageBuffer8BitAccess"},
    {&VkPhysicalDeviceVulkan12Features::runtimeDescriptorArray, "runtimeDescriptorArray"},
    {&VkPhysicalDeviceVulkan12Features::shaderSampledImageArrayNonUniformIndexing,
     "shaderSampledImageArrayNonUniformIndexing"},
    {&VkPhysicalDeviceVulkan12Features::descriptorBindingPartiallyBound, "descriptorBindingPartiallyBound"},
    {&VkPhysicalDeviceVulkan12Features::hostQueryReset, "hostQueryReset"},
};

std::vector<VkExtensionProperties> extensionsOf(VkPhysicalDevice physical) {
    uint32_t count = 0;
    VK_CHECK(vkEnumerateDeviceExtensionProperties(physical, nullptr, &count, nullptr));
    std::vector<VkExtensionProperties> extensions(count);
    VK_CHECK(vkEnumerateDeviceExtensionProperties(physical, nullptr, &count, extensions.data()));
    return extensions;
}

bool contains(const std::vector<VkExtensionProperties>& extensions, const char* name) {
    return std::any_of(extensions.begin(), extensions.end(), [&](const VkExtensionProperties& e) {
        return std::strcmp(e.extensionName, name) == 0;
    });
}

uint32_t largestDeviceHeap(const VkPhysicalDeviceMemoryProperties& memory) {
    uint32_t best = 0;
    VkDeviceSize bestSize = 0;
    for (uint32_t i = 0; i < memory.memoryHeapCount; ++i) {
        const VkMemoryHeap& heap = memory.memoryHeaps[i];
        if ((heap.flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT) == 0 || heap.size <= bestSize) continue;
        best = i;
        bestSize = heap.size;
    }
    return best;
}

std::vector<QueueFamily> readQueues(VkPhysicalDevice physical) {
    uint32_t count = 0;
    vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, nullptr);
    std::vector<VkQueueFamilyProperties> families(count);
    vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, families.data());
    std::vector<QueueFamily> queues;
    for (const VkQueueFamilyProperties& family : families)
        queues.push_back({.count = family.queueCount,
                          .graphics = (family.queueFlags & VK_QUEUE_GRAPHICS_BIT) != 0,
                          .compute = (family.queueFlags & VK_QUEUE_COMPUTE_BIT) != 0,
                          .transfer = (family.queueFlags & VK_QUEUE_TRANSFER_BIT) != 0});
    return queues;
}

std::string versionText(uint32_t version) {
    return std::to_string(VK_API_VERSION_MAJOR(version)) + "." +
           std::to_string(VK_API_VERSION_MINOR(version));
}

void readFeatures(VkPhysicalDevice physical, const std::vector<VkExtensionProperties>& extensions,
                  DeviceInfo& info) {
    const bool accel = contains(extensions, VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME) &&
                       contains(extensions, VK_KHR_DEFERRED_HOST_OPERATIONS_EXTENSION_NAME);
    const bool pipeline = accel && contains(extensions, VK_KHR_RAY_TRACING_PIPELINE_EXTENSION_NAME);
    const bool query = accel && contains(extensions, VK_KHR_RAY_QUERY_EXTENSION_NAME);
    FeatureChain features(accel, pipeline, query);
    vkGetPhysicalDeviceFeatures2(physical, &features.core);
    const bool accelWorks = accel && features.accel.accelerationStructure;
    info.rayTracingPipeline = accelWorks && pipeline && features.pipeline.rayTracingPipeline;
    info.rayQuery = accelWorks && query && features.query.rayQuery;
    info.fragmentStores = features.core.features.fragmentStoresAndAtomics;
    if (!features.core.features.shaderInt64) info.missing.emplace_back("shaderInt64");
    for (const Need& need : kNeeds)
        if (!(features.vulkan12.*need.feature)) info.missing.emplace_back(need.name);
}

} // namespace

FeatureChain::FeatureChain(bool withAccel, bool withPipeline, bool withQuery) {
    core.pNext = &vulkan12;
    void** end = &vulkan12.pNext;
    const auto append = [&end](auto& next) {
        *end = &next;
        end = &next.pNext;
    };
    if (withAccel) append(accel);
    if (withPipeline) append(pipeline);
    if (withQuery) append(query);
}

void enableFeatures(const FeatureChain& supported, FeatureChain& enabled) {
    for (const Need& need : kNeeds)
        enabled.vulkan12.*need.feature = VK_TRUE;
    enabled.vulkan12.descriptorIndexing = supported.vulkan12.descriptorIndexing;
    enabled.vulkan12.shaderInt8 = supported.vulkan12.shaderInt8;
    const VkPhysicalDeviceFeatures& has = supported.core.features;
    VkPhysicalDeviceFeatures& on = enabled.core.features;
    on.shaderInt64 = VK_TRUE;
    on.samplerAnisotropy = has.samplerAnisotropy;
    // Writable buffer references in a vertex or fragment shader need these, even where they are only read;
    // the CVM pass writes.
    on.vertexPipelineStoresAndAtomics = has.vertexPipelineStoresAndAtomics;
    on.fragmentStoresAndAtomics = has.fragmentStoresAndAtomics;
    enabled.accel.accelerationStructure = supported.accel.accelerationStructure;
    enabled.pipeline.rayTracingPipeline = supported.pipeline.rayTracingPipeline;
    enabled.query.rayQuery = supported.query.rayQuery;
}

bool hasDeviceExtension(VkPhysicalDevice physical, const char* name) {
    return contains(extensionsOf(physical), name);
}

std::vector<const char*> deviceExtensions(VkPhysicalDevice physical, const DeviceInfo& info) {
    std::vector<const char*> names;
    if (info.rayTracingPipeline || info.rayQuery) {
        names.push_back(VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME);
        names.push_back(VK_KHR_DEFERRED_HOST_OPERATIONS_EXTENSION_NAME);
    }
    if (info.rayTracingPipeline) names.push_back(VK_KHR_RAY_TRACING_PIPELINE_EXTENSION_NAME);
    if (info.rayQuery) names.push_back(VK_KHR_RAY_QUERY_EXTENSION_NAME);
    if (info.externalMemory) names.push_back(VK_KHR_EXTERNAL_MEMORY_FD_EXTENSION_NAME);
    if (info.importAlignment > 0) names.push_back(VK_EXT_EXTERNAL_MEMORY_HOST_EXTENSION_NAME);
    if (hasDeviceExtension(physical, VK_EXT_MEMORY_BUDGET_EXTENSION_NAME))
        names.push_back(VK_EXT_MEMORY_BUDGET_EXTENSION_NAME);
    return names;
}

uint64_t freeDeviceMemory(VkPhysicalDevice physical, bool memoryBudget) {
    VkPhysicalDeviceMemoryBudgetPropertiesEXT budget{
        VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MEMORY_BUDGET_PROPERTIES_EXT};
    VkPhysicalDeviceMemoryProperties2 memory{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MEMORY_PROPERTIES_2};
    if (memoryBudget) memory.pNext = &budget;
    vkGetPhysicalDeviceMemoryProperties2(physical, &memory);
    const uint32_t heap = largestDeviceHeap(memory.memoryProperties);
    if (!memoryBudget) return memory.memoryProperties.memoryHeaps[heap].size;
    return budget.heapBudget[heap] - std::min(budget.heapBudget[heap], budget.heapUsage[heap]);
}

VkDeviceSize readImportAlignment(VkPhysicalDevice physical,
                                 const std::vector<VkExtensionProperties>& extensions) {
    if (!contains(extensions, VK_EXT_EXTERNAL_MEMORY_HOST_EXTENSION_NAME)) return 0;
    VkPhysicalDeviceExternalMemoryHostPropertiesEXT host{
        VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_EXTERNAL_MEMORY_HOST_PROPERTIES_EXT};
    VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &host};
    vkGetPhysicalDeviceProperties2(physical, &properties);
    return host.minImportedHostPointerAlignment;
}

DeviceInfo readDeviceInfo(VkPhysicalDevice physical) {
    DeviceInfo info;
    VkPhysicalDeviceProperties properties;
    vkGetPhysicalDeviceProperties(physical, &properties);
    info.name = properties.deviceName;
    info.apiVersion = properties.apiVersion;
    info.driverVersion = properties.driverVersion;
    info.type = properties.deviceType;
    info.queues = readQueues(physical);
    if (properties.apiVersion < VK_API_VERSION_1_2) {
        // Such a driver does not know the feature structs of Vulkan 1.2, so it is asked nothing more.
        info.missing.push_back("Vulkan 1.2 (has " + versionText(properties.apiVersion) + ")");
        return info;
    }
    VkPhysicalDeviceVulkan12Properties vulkan12{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_PROPERTIES};
    VkPhysicalDeviceVulkan11Properties vulkan11{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_PROPERTIES,
                                                &vulkan12};
    VkPhysicalDeviceProperties2 properties2{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &vulkan11};
    vkGetPhysicalDeviceProperties2(physical, &properties2);
    info.driver = vulkan12.driverName;
    if (vulkan12.driverInfo[0] != '\0') info.driver += std::string(" ") + vulkan12.driverInfo;
    std::copy_n(vulkan11.deviceUUID, VK_UUID_SIZE, info.uuid.begin());

    const std::vector<VkExtensionProperties> extensions = extensionsOf(physical);
    info.externalMemory = contains(extensions, VK_KHR_EXTERNAL_MEMORY_FD_EXTENSION_NAME);
    info.importAlignment = readImportAlignment(physical, extensions);
    info.deviceMemory = freeDeviceMemory(physical, false);
    info.freeMemory = freeDeviceMemory(physical, contains(extensions, VK_EXT_MEMORY_BUDGET_EXTENSION_NAME));
    readFeatures(physical, extensions, info);
    if (std::none_of(info.queues.begin(), info.queues.end(),
                     [](const QueueFamily& family) { return family.graphics && family.compute; }))
        info.missing.emplace_back("a queue with graphics and compute");
    return info;
}

const char* deviceTypeName(VkPhysicalDeviceType type) {
    switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
        return "discrete";
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
        return "integrated";
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
        return "virtual";
    case VK_PHYSICAL_DEVICE_TYPE_CPU:
        return "software";
    default:
        return "other";
    }
}

std::vector<DeviceInfo> listDevices() {
    if (!openLoader()) return {};
    const Instance instance = createInstance({});
    if (instance.handle == VK_NULL_HANDLE) return {};
    // Core functions are the loader's own and serve every instance, so those of a living Device are kept.
    if (volkGetLoadedInstance() == VK_NULL_HANDLE) volkLoadInstance(instance.handle);
    std::vector<DeviceInfo> infos;
    try {
        for (VkPhysicalDevice physical : physicalDevices(instance.handle)) {
            infos.push_back(readDeviceInfo(physical));
            infos.back().index = static_cast<uint32_t>(infos.size() - 1);
        }
    } catch (...) {
        vkDestroyInstance(instance.handle, nullptr);
        throw;
    }
    vkDestroyInstance(instance.handle, nullptr);
    return infos;
}

} // namespace relume::vk
