#pragma once

#include <vector>

#include "bake/vk/device.h"

namespace relume::vk {

/// The feature structs that Relume asks about and switches on, chained. It is not copyable: the chain points
/// into itself.
struct FeatureChain {
    VkPhysicalDeviceFeatures2 core{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2};
    VkPhysicalDeviceVulkan12Features vulkan12{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES};
    VkPhysicalDeviceAccelerationStructureFeaturesKHR accel{
        VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_FEATURES_KHR};
    VkPhysicalDeviceRayTracingPipelineFeaturesKHR pipeline{
        VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_TRACING_PIPELINE_FEATURES_KHR};
    VkPhysicalDeviceRayQueryFeaturesKHR query{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_QUERY_FEATURES_KHR};

    /// Chains vulkan12 and, of the ray tracing structs, those asked for.
    FeatureChain(bool withAccel, bool withPipeline, bool withQuery);
    FeatureChain(const FeatureChain&) = delete;
    FeatureChain& operator=(const FeatureChain&) = delete;
};

/// Switches on the features that Relume needs and those of its optional ones that `supported` has.
void enableFeatures(const FeatureChain& supported, FeatureChain& enabled);
/// Returns the device extensions to switch on.
std::vector<const char*> deviceExtensions(VkPhysicalDevice physical, const DeviceInfo& info);
bool hasDeviceExtension(VkPhysicalDevice physical, const char* name);

/// Reads everything about a device but its `index`.
DeviceInfo readDeviceInfo(VkPhysicalDevice physical);
/// Returns the free bytes of the largest device-local heap, by VK_EXT_memory_budget, else its size.
uint64_t freeDeviceMemory(VkPhysicalDevice physical, bool memoryBudget);

} // namespace relume::vk
