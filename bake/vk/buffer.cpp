#include "bake/vk/buffer.h"

#include "bake/vk/memory.h"
#include "bake/vk/staging.h"

#include <bit>
#include <utility>

namespace relume::vk {

namespace {

uint32_t memoryTypeFor(const Device& device, Memory memory, uint32_t typeBits) {
    if (memory == Memory::Device) return device.deviceMemoryType(typeBits);
    constexpr VkMemoryPropertyFlags coherent =
        VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    const uint32_t cached = device.memoryType(typeBits, coherent | VK_MEMORY_PROPERTY_HOST_CACHED_BIT);
    return cached != ~0u ? cached : device.memoryType(typeBits, coherent);
}

// Drivers get memory of the host on one thread, 2 GB in a second. From this size on [bytes] all cores get it,
// and the driver takes it over.
constexpr VkDeviceSize kManyPages = VkDeviceSize{64} << 20;

constexpr VkExternalMemoryHandleTypeFlagBits kImported =
    VK_EXTERNAL_MEMORY_HANDLE_TYPE_HOST_ALLOCATION_BIT_EXT;

// Returns the types of memory that this memory of the host can be.
uint32_t importedTypes(const Device& device, const std::byte* bytes) {
    VkMemoryHostPointerPropertiesEXT properties{VK_STRUCTURE_TYPE_MEMORY_HOST_POINTER_PROPERTIES_EXT};
    check(vkGetMemoryHostPointerPropertiesEXT(device.handle(), kImported, bytes, &properties),
          "vkGetMemoryHostPointerPropertiesEXT");
    return properties.memoryTypeBits;
}

} // namespace

bool Buffer::importable(const Device& device, std::span<const std::byte> bytes) {
    const VkDeviceSize alignment = device.info().importAlignment;
    return alignment > 0 && !bytes.empty() && bytes.size() % alignment == 0 &&
           std::bit_cast<uintptr_t>(bytes.data()) % alignment == 0;
}

Buffer::Buffer(const Device& device, const Desc& desc) : device_(&device) {
    ASSERT(desc.size > 0);
    try {
        if (!createOfPages(desc)) create(desc);
    } catch (...) {
        release();
        throw;
    }
}

// Makes a large buffer of the host of pages that all cores have got; false where that cannot be. A driver may
// refuse any memory.
bool Buffer::createOfPages(const Desc& desc) {
    if (desc.memory != Memory::Host || !desc.imported.empty() || desc.size < kManyPages) return false;
    if (device_->info().importAlignment == 0) return false;
    const VkDeviceSize bytes = (desc.size + HostPages::kGrain - 1) / HostPages::kGrain * HostPages::kGrain;
    pages_ = HostPages(device_->workers(), bytes);
    Desc imported = desc;
    imported.imported = pages_.bytes();
    try {
        if (pages_ && importable(*device_, pages_.bytes())) {
            create(imported);
            return true;
        }
    } catch (const Error&) { // then it is made as others are
    }
    release();
    mapped_ = nullptr;
    return false;
}

void Buffer::create(const Desc& desc) {
    const bool imports = !desc.imported.empty();
    ASSERT(!imports || (desc.memory == Memory::Host && desc.imported.size() >= desc.size));
    VkExternalMemoryBufferCreateInfo external{VK_STRUCTURE_TYPE_EXTERNAL_MEMORY_BUFFER_CREATE_INFO};
    external.handleTypes = kImported;
    VkBufferCreateInfo info{VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, imports ? &external : nullptr};
    info.size = desc.size;
    info.usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT |
                 VK_BUFFER_USAGE_TRANSFER_DST_BIT | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT |
                 desc.extraUsage;
    const std::string what = std::string("buffer '") + desc.name + "' of " + inMiB(desc.size);
    checkMemory(*device_, vkCreateBuffer(device_->handle(), &info, nullptr, &buffer_), "vkCreateBuffer",
                what);
    VkMemoryRequirements needs;
    vkGetBufferMemoryRequirements(device_->handle(), buffer_, &needs);

    if (imports) needs.memoryTypeBits &= importedTypes(*device_, desc.imported.data());
    const uint32_t type = memoryTypeFor(*device_, desc.memory, needs.memoryTypeBits);
    VkImportMemoryHostPointerInfoEXT import{VK_STRUCTURE_TYPE_IMPORT_MEMORY_HOST_POINTER_INFO_EXT};
    import.handleType = kImported;
    import.pHostPointer = desc.imported.data();
    VkMemoryAllocateFlagsInfo byAddress{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_FLAGS_INFO};
    byAddress.flags = VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT;
    if (imports) byAddress.pNext = &import;
    memory_ = allocateMemory(*device_, {.size = imports ? desc.imported.size() : needs.size,
                                        .type = type,
                                        .ofHost = desc.memory == Memory::Host,
                                        .chain = &byAddress,
                                        .name = desc.name,
                                        .what = what});
    VK_CHECK(vkBindBufferMemory(device_->handle(), buffer_, memory_.handle(), 0));

    const VkMemoryPropertyFlags properties = device_->memoryProperties(type);
    constexpr VkMemoryPropertyFlags coherent =
        VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    if ((properties & coherent) == coherent)
        VK_CHECK(vkMapMemory(device_->handle(), memory_.handle(), 0, VK_WHOLE_SIZE, 0, &mapped_));
    size_ = desc.size;
    VkBufferDeviceAddressInfo addressInfo{VK_STRUCTURE_TYPE_BUFFER_DEVICE_ADDRESS_INFO};
    addressInfo.buffer = buffer_;
    address_ = vkGetBufferDeviceAddress(device_->handle(), &addressInfo);
    device_->setName(VK_OBJECT_TYPE_BUFFER, reinterpret_cast<uint64_t>(buffer_), desc.name);
}

Buffer::~Buffer() {
    release();
}

Buffer::Buffer(Buffer&& other) noexcept
    : device_(std::exchange(other.device_, nullptr)), buffer_(std::exchange(other.buffer_, VK_NULL_HANDLE)),
      pages_(std::move(other.pages_)), memory_(std::move(other.memory_)),
      size_(std::exchange(other.size_, 0)), address_(std::exchange(other.address_, 0)),
      mapped_(std::exchange(other.mapped_, nullptr)) {}

Buffer& Buffer::operator=(Buffer&& other) noexcept {
    if (this == &other) return *this;
    release();
    device_ = std::exchange(other.device_, nullptr);
    buffer_ = std::exchange(other.buffer_, VK_NULL_HANDLE);
    memory_ = std::move(other.memory_);
    pages_ = std::move(other.pages_);
    size_ = std::exchange(other.size_, 0);
    address_ = std::exchange(other.address_, 0);
    mapped_ = std::exchange(other.mapped_, nullptr);
    return *this;
}

void Buffer::release() {
    if (device_ == nullptr) return;
    vkDestroyBuffer(device_->handle(), buffer_, nullptr);
    memory_.release();
    pages_.release(); // which the memory was made of
    buffer_ = VK_NULL_HANDLE;
}

void upload(const Device& device, const Buffer& buffer, const void* data, VkDeviceSize size,
            VkDeviceSize offset) {
    ASSERT(offset + size <= buffer.size());
    if (size > 0) device.staging().upload(buffer, data, size, offset);
}

std::vector<BufferPart> partsOf(std::span<const uint32_t> indices, VkDeviceSize each) {
    // So many bytes between two parts are copied along: a region of its own costs a GPU as much.
    constexpr VkDeviceSize kGap = 4096;
    std::vector<BufferPart> parts;
    for (const uint32_t index : indices) {
        const VkDeviceSize offset = index * each;
        if (parts.empty() || offset > parts.back().offset + parts.back().size + kGap)
            parts.push_back({offset, 0});
        parts.back().size = offset + each - parts.back().offset;
    }
    return parts;
}

void uploadParts(const Device& device, const Buffer& buffer, const void* data,
                 std::span<const BufferPart> parts) {
    device.staging().uploadParts(buffer, data, parts);
}

void download(const Device& device, const Buffer& buffer, void* data, VkDeviceSize size,
              VkDeviceSize offset) {
    ASSERT(offset + size <= buffer.size());
    if (size > 0) device.staging().download(buffer, data, size, offset);
}

} // namespace relume::vk
