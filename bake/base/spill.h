#pragma once

#include <cstdint>

#include "bake/vk/buffer.h"

namespace relume {

/// Tells which of a bake's buffers are in the host's memory, where that of the device is too small for all.
/// The device reads and writes them there, in the order of patches, so that each batch streams its own part.
/// Each value adds something to those before; what costs least for the bytes that it frees comes first. What
/// rays and links read anywhere stays on the device.
enum class Spill : uint8_t {
    None,
    Smoothing, // its rows and distances, and the result: only when an error is told or a result is made
    Direct,    // direct light and its sums: little of it in a bounce
    Links,     // sums over links: in each sample pass
    Light,     // colours, and light before and after a bounce: in each bounce
};
constexpr Spill kMostSpill = Spill::Light;

/// Returns where a buffer is that goes to the host from this value on.
constexpr vk::Memory memoryFrom(Spill first, Spill spill) {
    return spill >= first ? vk::Memory::Host : vk::Memory::Device;
}

/// Bytes on a device, and in the host's memory that the device reads and writes.
struct SpilledBytes {
    uint64_t device = 0, host = 0;

    /// Adds those of a buffer that goes to the host from `first` on.
    void add(uint64_t bytes, Spill first, Spill spill) { (spill >= first ? host : device) += bytes; }
};

} // namespace relume
