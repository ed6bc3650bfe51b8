#include "bake/vk/program.h"

#include <algorithm>
#include <utility>

namespace relume::vk {

Sampler::Sampler(const Device& device, VkFilter filter, VkSamplerAddressMode u, VkSamplerAddressMode v,
                 float maxAnisotropy)
    : device_(&device) {
    VkSamplerCreateInfo info{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
    info.magFilter = info.minFilter = filter;
    info.mipmapMode =
        filter == VK_FILTER_LINEAR ? VK_SAMPLER_MIPMAP_MODE_LINEAR : VK_SAMPLER_MIPMAP_MODE_NEAREST;
    info.addressModeU = u;
    info.addressModeV = v;
    info.addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
    info.maxLod = VK_LOD_CLAMP_NONE;
    // Mesa's software rasterizer returns NaN where the derivatives are zero: a face with one UV for all
    // corners.
    info.anisotropyEnable = device.anisotropy() && maxAnisotropy > 1.0f && !device.info().software();
    info.maxAnisotropy = std::clamp(maxAnisotropy, 1.0f, device.limits().maxSamplerAnisotropy);
    VK_CHECK(vkCreateSampler(device.handle(), &info, nullptr, &sampler_));
}

Sampler::~Sampler() {
    release();
}

Sampler::Sampler(Sampler&& other) noexcept
    : device_(std::exchange(other.device_, nullptr)),
      sampler_(std::exchange(other.sampler_, VK_NULL_HANDLE)) {}

Sampler& Sampler::operator=(Sampler&& other) noexcept {
    if (this == &other) return *this;
    release();
    device_ = std::exchange(other.device_, nullptr);
    sampler_ = std::exchange(other.sampler_, VK_NULL_HANDLE);
    return *this;
}

void Sampler::release() {
    if (device_ != nullptr) vkDestroySampler(device_->handle(), sampler_, nullptr);
}

} // namespace relume::vk
