#pragma once

#include <span>
#include <vector>

#include "assets/base/host_pages.h"
#include "bake/vk/memory_block.h"

namespace relume::vk {

enum class Memory {
    Device, // device-local; mapped all the same where the device shares memory with the CPU
    Host,   // host-visible, coherent, cached: staging, readback, results that the CPU writes, what is spilled
};

/// Owns a VkBuffer and its memory; move-only. A buffer is always usable as storage, as transfer source and
/// target, and by address.
class Buffer {
public:
    struct Desc {
        VkDeviceSize size = 0; // [bytes], > 0
        Memory memory = Memory::Device;
        VkBufferUsageFlags extraUsage = 0; // acceleration structure input, storage, shader binding table
        const char* name = "";             // for validation messages and captures
        // Memory of the caller's for it, `size` bytes or more, with Memory::Host alone: see importable().
        std::span<std::byte> imported = {};
    };
    /// Tells whether a buffer can be made of this memory of the caller's, as far as place and size go.
    static bool importable(const Device& device, std::span<const std::byte> bytes);
    Buffer() = default;
    Buffer(const Device& device,
           const Desc& desc); // throws Error (out of memory: names the buffer and its size)
    ~Buffer();
    Buffer(Buffer&& other) noexcept;
    Buffer& operator=(Buffer&& other) noexcept;

    VkBuffer handle() const { return buffer_; }
    VkDeviceSize size() const { return size_; }
    VkDeviceAddress address() const { return address_; }
    void* mapped() const { return mapped_; } // nullptr where the CPU cannot see it
    template<typename T>
    T* as() const { // the contents of a buffer that the CPU sees
        ASSERT(mapped_);
        return static_cast<T*>(mapped_);
    }
    explicit operator bool() const { return buffer_ != VK_NULL_HANDLE; }

private:
    bool createOfPages(const Desc& desc);
    void create(const Desc& desc);
    void release();
    const Device* device_ = nullptr;
    VkBuffer buffer_ = VK_NULL_HANDLE;
    HostPages pages_; // that memory_ is made of, where it is large and the host's
    MemoryBlock memory_;
    VkDeviceSize size_ = 0;
    VkDeviceAddress address_ = 0;
    void* mapped_ = nullptr;
};

/// Copy from host to device and back, at once: both wait for the device. Offsets and sizes are in bytes.
void upload(const Device& device, const Buffer& buffer, const void* data, VkDeviceSize size,
            VkDeviceSize offset = 0);
void download(const Device& device, const Buffer& buffer, void* data, VkDeviceSize size,
              VkDeviceSize offset = 0);

/// A range of bytes in an array of which host and device have a copy each.
struct BufferPart {
    VkDeviceSize offset = 0, size = 0;
};
/// Returns the parts around the elements of these indices (ascending), of so many bytes each; parts close to
/// each other become one.
std::vector<BufferPart> partsOf(std::span<const uint32_t> indices, VkDeviceSize each);
/// Uploads, as upload() does, these parts of the array that begins at `data`.
void uploadParts(const Device& device, const Buffer& buffer, const void* data,
                 std::span<const BufferPart> parts);
template<typename T>
void uploadElements(const Device& device, const Buffer& buffer, const std::vector<T>& values,
                    std::span<const uint32_t> indices) {
    uploadParts(device, buffer, values.data(), partsOf(indices, sizeof(T)));
}

/// Does so with values that are made as they are needed: valueOf(index) returns a T. It is asked for elements
/// between those of `indices`, too.
template<typename T, typename ValueOf>
void uploadMade(const Device& device, const Buffer& buffer, std::span<const uint32_t> indices,
                const ValueOf& valueOf) {
    if (indices.empty()) return;
    std::vector<T> values(size_t{indices.back()} + 1);
    const std::vector<BufferPart> parts = partsOf(indices, sizeof(T));
    for (const BufferPart& part : parts)
        for (size_t i = part.offset / sizeof(T); i < (part.offset + part.size) / sizeof(T); ++i)
            values[i] = valueOf(static_cast<uint32_t>(i));
    uploadParts(device, buffer, values.data(), parts);
}

/// Returns a buffer with a copy of `values`; it has at least 16 bytes, so that an empty list has an
/// address too.
template<typename T>
Buffer makeBuffer(const Device& device, std::span<const T> values, const char* name,
                  VkBufferUsageFlags extraUsage = 0, Memory memory = Memory::Device) {
    Buffer buffer(device, {.size = values.size_bytes() < 16 ? 16 : values.size_bytes(),
                           .memory = memory,
                           .extraUsage = extraUsage,
                           .name = name});
    if (!values.empty()) upload(device, buffer, values.data(), values.size_bytes());
    return buffer;
}
template<typename T>
Buffer makeBuffer(const Device& device, const std::vector<T>& values, const char* name,
                  VkBufferUsageFlags extraUsage = 0, Memory memory = Memory::Device) {
    return makeBuffer(device, std::span<const T>(values), name, extraUsage, memory);
}

template<typename T>
std::vector<T> readBuffer(const Device& device, const Buffer& buffer, size_t count, size_t first = 0) {
    std::vector<T> values(count);
    if (count > 0) download(device, buffer, values.data(), count * sizeof(T), first * sizeof(T));
    return values;
}

} // namespace relume::vk
