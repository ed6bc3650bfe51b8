#pragma once

#include "bake/layers/layer_store.h"

namespace relume {

/// Keeps layers without a Vulkan device. There is none behind the reference that the store is made with, for
/// only a buffer needs it, and no layer here has any.
class StoreWithoutDevice {
public:
    /// Takes for how many layers there is memory: those that are shown, former ones and a spare one.
    /// onDevice of them are the device's.
    explicit StoreWithoutDevice(uint64_t room) : StoreWithoutDevice(room, room) {}
    StoreWithoutDevice(uint64_t room, uint64_t onDevice)
        : store_(place_.device, kLightBytes, room * kBuffersOfLayer * kLightBytes,
                 onDevice * kBuffersOfLayer * kLightBytes) {}

    LayerStore* operator->() { return &store_; }
    const LayerStore* operator->() const { return &store_; }

private:
    static constexpr uint64_t kLightBytes = 16, kBuffersOfLayer = 2;
    union Place {
        Place() : none(0) {}
        ~Place() {}
        char none;
        vk::Device device; // never made
    };
    Place place_;
    LayerStore store_;
};

} // namespace relume
