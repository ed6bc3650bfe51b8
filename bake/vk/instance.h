#pragma once

#include <vector>

#include <volk.h>

namespace relume::vk {

struct InstanceDesc {
    bool validation = false;
    PFN_vkDebugUtilsMessengerCallbackEXT onMessage = nullptr; // hears instance creation and destruction too
    void* userData = nullptr;
};

struct Instance {
    VkInstance handle = VK_NULL_HANDLE; // null: no driver
    bool debugUtils = false;
};

/// Opens the loader; returns false if this machine has none.
[[nodiscard]] bool openLoader();
/// Makes a Vulkan 1.2 instance; needs openLoader(). Throws Error when validation is asked for and its layer
/// is missing.
Instance createInstance(const InstanceDesc& desc);
VkDebugUtilsMessengerCreateInfoEXT messengerInfo(const InstanceDesc& desc);
std::vector<VkPhysicalDevice> physicalDevices(VkInstance instance);

} // namespace relume::vk
