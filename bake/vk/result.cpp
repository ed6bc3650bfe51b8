#include "bake/vk/device.h"

#include <algorithm>

namespace relume::vk {

const char* resultName(VkResult result) {
#define NAME(value)                                                                                          \
    case value:                                                                                              \
        return #value
    switch (result) {
        NAME(VK_SUCCESS);
        NAME(VK_NOT_READY);
        NAME(VK_TIMEOUT);
        NAME(VK_EVENT_SET);
        NAME(VK_EVENT_RESET);
        NAME(VK_INCOMPLETE);
        NAME(VK_ERROR_OUT_OF_HOST_MEMORY);
        NAME(VK_ERROR_OUT_OF_DEVICE_MEMORY);
        NAME(VK_ERROR_INITIALIZATION_FAILED);
        NAME(VK_ERROR_DEVICE_LOST);
        NAME(VK_ERROR_MEMORY_MAP_FAILED);
        NAME(VK_ERROR_LAYER_NOT_PRESENT);
        NAME(VK_ERROR_EXTENSION_NOT_PRESENT);
        NAME(VK_ERROR_FEATURE_NOT_PRESENT);
        NAME(VK_ERROR_INCOMPATIBLE_DRIVER);
        NAME(VK_ERROR_TOO_MANY_OBJECTS);
        NAME(VK_ERROR_FORMAT_NOT_SUPPORTED);
        NAME(VK_ERROR_FRAGMENTED_POOL);
        NAME(VK_ERROR_UNKNOWN);
        NAME(VK_ERROR_OUT_OF_POOL_MEMORY);
        NAME(VK_ERROR_INVALID_EXTERNAL_HANDLE);
        NAME(VK_ERROR_FRAGMENTATION);
        NAME(VK_ERROR_INVALID_OPAQUE_CAPTURE_ADDRESS);
    default:
        return "an unknown VkResult";
    }
#undef NAME
}

void check(VkResult result, const char* call) {
    if (result >= 0) return; // VK_NOT_READY and its like are answers
    std::string what = call;
    what.resize(std::min(what.find('('), what.size()));
    std::string message = what + ": " + resultName(result) + " (" + std::to_string(result) + ")";
    if (result == VK_ERROR_DEVICE_LOST)
        message += ": the driver reset the GPU: try a smaller --batch-ms or another --device";
    else if (result == VK_ERROR_OUT_OF_DEVICE_MEMORY || result == VK_ERROR_OUT_OF_HOST_MEMORY)
        message += ": use a smaller --size or close other programs";
    throw Error(message);
}

} // namespace relume::vk
