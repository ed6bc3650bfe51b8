#include "bake/vk/pipeline_cache.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include <unistd.h>

namespace relume::vk {

namespace {

std::filesystem::path cacheFile(const DeviceInfo& info) {
    std::filesystem::path folder;
    if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache != nullptr && cache[0] == '/')
        folder = cache;
    else if (const char* home = std::getenv("HOME"); home != nullptr && home[0] == '/')
        folder = std::filesystem::path(home) / ".cache";
    else
        return {};
    static const char digits[] = "0123456789abcdef";
    std::string name = "pipelines-";
    for (uint8_t byte : info.uuid)
        name += {digits[byte >> 4], digits[byte & 15]};
    return folder / "relume" / (name + "-" + std::to_string(info.driverVersion) + ".bin");
}

} // namespace

VkPipelineCache loadPipelineCache(VkDevice device, const DeviceInfo& info) {
    std::ifstream file(cacheFile(info), std::ios::binary);
    const std::vector<char> data{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
    VkPipelineCacheCreateInfo create{VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO};
    create.initialDataSize = data.size();
    create.pInitialData = data.data();
    VkPipelineCache cache = VK_NULL_HANDLE;
    if (vkCreatePipelineCache(device, &create, nullptr, &cache) == VK_SUCCESS) return cache;
    create.initialDataSize = 0; // a damaged file
    return vkCreatePipelineCache(device, &create, nullptr, &cache) == VK_SUCCESS ? cache : VK_NULL_HANDLE;
}

void savePipelineCache(VkDevice device, const DeviceInfo& info, VkPipelineCache cache) noexcept try {
    const std::filesystem::path path = cacheFile(info);
    size_t size = 0;
    if (path.empty() || vkGetPipelineCacheData(device, cache, &size, nullptr) != VK_SUCCESS || size == 0)
        return;
    std::error_code error;
    if (std::filesystem::file_size(path, error) == size && !error) return; // nothing new
    std::vector<char> data(size);
    if (vkGetPipelineCacheData(device, cache, &size, data.data()) != VK_SUCCESS) return;
    std::filesystem::create_directories(path.parent_path(), error);
    const std::filesystem::path temporary = path.string() + "." + std::to_string(getpid());
    {
        std::ofstream file(temporary, std::ios::binary);
        file.write(data.data(), static_cast<std::streamsize>(size));
        if (!file.flush()) {
            std::filesystem::remove(temporary, error);
            return;
        }
    }
    std::filesystem::rename(temporary, path, error);
    if (error) std::filesystem::remove(temporary, error);
} catch (...) {
}

} // namespace relume::vk
