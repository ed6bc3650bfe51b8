#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "bake/baker/memory_needs.h"
#include "bake/vk/device.h"

namespace relume {

/// Tells what a device and its host have to give to a bake.
struct BakeRoom {
    uint64_t device = 0;          // free memory of the device [bytes]
    std::optional<uint64_t> host; // and of the host, where it tells
    uint32_t imageEdge = 0;       // the largest image that the device takes [texels]
    bool software = false;        // what it needs counts the host's copies
    bool shared = false;          // its memory is the host's
    bool limited = false;         // the user allows no more of the device's
    std::string name = {};        // of the device, for messages
};
/// Returns the room of a device and of this machine as they are now.
BakeRoom roomOn(const vk::Device& device);

/// Tells where the buffers of a bake are.
struct MemoryPlan {
    Spill spill = Spill::None;
    uint64_t spilled = 0;     // bytes that the host's memory holds of them
    std::string problem = {}; // what is wrong with the size, and which one fits; "": it fits
};
/// Plans a bake's memory before anything is allocated. What the settings say is spilled, and more only where
/// the device has no room even without the links of a whole sample pass, which are kept else. What the bake
/// holds by itself on the host is counted, too.
MemoryPlan planMemory(const BakeSettings& settings, const SceneExtent& scene, const BakeRoom& room);
/// Returns the least that must be spilled where so many bytes of the device are free, once it is known how
/// many patches there are: never more than planMemory() said.
Spill spillOf(const BakeSettings& settings, const SceneExtent& scene, const SolverExtent& solver,
              uint64_t free);

} // namespace relume
