#include "bake/vk/accel.h"

#include "bake/vk/commands.h"

#include <algorithm>
#include <utility>

namespace relume::vk {

namespace {

constexpr VkBufferUsageFlags kInputUsage =
    VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_BIT_KHR;
constexpr VkBufferUsageFlags kStorageUsage = VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_STORAGE_BIT_KHR;

VkAccelerationStructureKHR createIn(const Device& device, const Buffer& buffer, VkDeviceSize size,
                                    VkAccelerationStructureTypeKHR type) {
    VkAccelerationStructureCreateInfoKHR info{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_CREATE_INFO_KHR};
    info.buffer = buffer.handle();
    info.size = size;
    info.type = type;
    VkAccelerationStructureKHR accel = VK_NULL_HANDLE;
    VK_CHECK(vkCreateAccelerationStructureKHR(device.handle(), &info, nullptr, &accel));
    return accel;
}

VkDeviceAddress addressOf(const Device& device, VkAccelerationStructureKHR accel) {
    VkAccelerationStructureDeviceAddressInfoKHR info{
        VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_DEVICE_ADDRESS_INFO_KHR};
    info.accelerationStructure = accel;
    return vkGetAccelerationStructureDeviceAddressKHR(device.handle(), &info);
}

// Scratch memory and the address in it that meets the device's alignment.
struct Scratch {
    Buffer buffer;
    VkDeviceAddress address = 0;
};

Scratch makeScratch(const Device& device, VkDeviceSize size) {
    const VkDeviceSize alignment = std::max(1u, device.accelScratchAlignment());
    Scratch scratch;
    scratch.buffer = Buffer(device, {.size = size + alignment, .name = "acceleration structure scratch"});
    scratch.address = (scratch.buffer.address() + alignment - 1) / alignment * alignment;
    return scratch;
}

VkAccelerationStructureGeometryKHR triangles(const Buffer& positions, size_t vertexCount,
                                             VkGeometryFlagsKHR flags) {
    VkAccelerationStructureGeometryKHR geometry{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_KHR};
    geometry.geometryType = VK_GEOMETRY_TYPE_TRIANGLES_KHR;
    geometry.flags = flags;
    geometry.geometry.triangles = {VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_TRIANGLES_DATA_KHR};
    geometry.geometry.triangles.vertexFormat = VK_FORMAT_R32G32B32_SFLOAT;
    geometry.geometry.triangles.vertexData.deviceAddress = positions.address();
    geometry.geometry.triangles.vertexStride = sizeof(glm::vec3);
    geometry.geometry.triangles.maxVertex = vertexCount == 0 ? 0 : static_cast<uint32_t>(vertexCount - 1);
    geometry.geometry.triangles.indexType = VK_INDEX_TYPE_NONE_KHR;
    return geometry;
}

// The compacted size is known only after the build.
class SizeQuery {
public:
    explicit SizeQuery(const Device& device) : device_(device) {
        VkQueryPoolCreateInfo info{VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO};
        info.queryType = VK_QUERY_TYPE_ACCELERATION_STRUCTURE_COMPACTED_SIZE_KHR;
        info.queryCount = 1;
        VK_CHECK(vkCreateQueryPool(device.handle(), &info, nullptr, &pool_));
    }
    ~SizeQuery() { vkDestroyQueryPool(device_.handle(), pool_, nullptr); }
    SizeQuery(const SizeQuery&) = delete;
    SizeQuery& operator=(const SizeQuery&) = delete;

    void record(VkCommandBuffer cmd, VkAccelerationStructureKHR accel) {
        vkCmdResetQueryPool(cmd, pool_, 0, 1);
        vkCmdWriteAccelerationStructuresPropertiesKHR(
            cmd, 1, &accel, VK_QUERY_TYPE_ACCELERATION_STRUCTURE_COMPACTED_SIZE_KHR, pool_, 0);
    }
    VkDeviceSize size() const {
        uint64_t size = 0;
        VK_CHECK(vkGetQueryPoolResults(device_.handle(), pool_, 0, 1, sizeof(size), &size, sizeof(size),
                                       VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT));
        return size;
    }

private:
    const Device& device_;
    VkQueryPool pool_ = VK_NULL_HANDLE;
};

} // namespace

Accel::Accel(const Device& device, std::span<const glm::vec3> positions, uint32_t opaqueCount)
    : device_(&device) {
    ASSERT(positions.size() % 3 == 0 && opaqueCount <= positions.size() / 3);
    if (!device.info().rayTracingPipeline && !device.info().rayQuery)
        throw Error("device '" + device.info().name + "' has no ray tracing: use --tracer bvh or embree");
    if (positions.size_bytes() > UINT32_MAX) // offsets of geometries are 32 bits wide
        throw Error("the scene has " + std::to_string(positions.size() / 3) +
                    " triangles, too many for one acceleration structure: use --tracer bvh or embree");
    try {
        buildBottom(positions, opaqueCount);
        buildTop();
        bytes_ = bottomBuffer_.size() + topBuffer_.size();
    } catch (...) {
        release();
        throw;
    }
}

void Accel::buildBottom(std::span<const glm::vec3> positions, uint32_t opaqueCount) {
    const auto total = static_cast<uint32_t>(positions.size() / 3);
    const Buffer vertices = makeBuffer(*device_, positions, "acceleration structure vertices", kInputUsage);
    const VkAccelerationStructureGeometryKHR geometries[2] = {
        triangles(vertices, positions.size(), VK_GEOMETRY_OPAQUE_BIT_KHR),
        triangles(vertices, positions.size(), VK_GEOMETRY_NO_DUPLICATE_ANY_HIT_INVOCATION_BIT_KHR)};
    const uint32_t counts[2] = {opaqueCount, total - opaqueCount};
    VkAccelerationStructureBuildGeometryInfoKHR info{
        VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_GEOMETRY_INFO_KHR};
    info.type = VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR;
    info.flags = VK_BUILD_ACCELERATION_STRUCTURE_PREFER_FAST_TRACE_BIT_KHR |
                 VK_BUILD_ACCELERATION_STRUCTURE_ALLOW_COMPACTION_BIT_KHR;
    info.mode = VK_BUILD_ACCELERATION_STRUCTURE_MODE_BUILD_KHR;
    info.geometryCount = counts[1] > 0 ? 2 : 1;
    info.pGeometries = geometries;
    VkAccelerationStructureBuildSizesInfoKHR sizes{
        VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_SIZES_INFO_KHR};
    vkGetAccelerationStructureBuildSizesKHR(
        device_->handle(), VK_ACCELERATION_STRUCTURE_BUILD_TYPE_DEVICE_KHR, &info, counts, &sizes);

    bottomBuffer_ = Buffer(*device_, {.size = sizes.accelerationStructureSize,
                                      .extraUsage = kStorageUsage,
                                      .name = "bottom level acceleration structure"});
    bottom_ = createIn(*device_, bottomBuffer_, sizes.accelerationStructureSize, info.type);
    const Scratch scratch = makeScratch(*device_, sizes.buildScratchSize);
    info.dstAccelerationStructure = bottom_;
    info.scratchData.deviceAddress = scratch.address;
    const VkAccelerationStructureBuildRangeInfoKHR ranges[2] = {
        {counts[0], 0, 0, 0}, {counts[1], static_cast<uint32_t>(opaqueCount * 3 * sizeof(glm::vec3)), 0, 0}};
    const VkAccelerationStructureBuildRangeInfoKHR* rangesOfInfo = ranges;

    SizeQuery compacted(*device_);
    Commands commands(*device_);
    VkCommandBuffer cmd = commands.begin();
    vkCmdBuildAccelerationStructuresKHR(cmd, 1, &info, &rangesOfInfo);
    barrier(cmd);
    compacted.record(cmd, bottom_);
    commands.run();
    compactBottom(compacted.size());
}

void Accel::compactBottom(VkDeviceSize size) {
    if (size == 0 || size >= bottomBuffer_.size()) return;
    Buffer buffer(*device_,
                  {.size = size, .extraUsage = kStorageUsage, .name = "bottom level acceleration structure"});
    VkAccelerationStructureKHR compact =
        createIn(*device_, buffer, size, VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR);
    std::swap(buffer, bottomBuffer_);
    std::swap(compact, bottom_); // now `compact` is the large one, in `buffer`
    try {
        Commands commands(*device_);
        VkCommandBuffer cmd = commands.begin();
        VkCopyAccelerationStructureInfoKHR info{VK_STRUCTURE_TYPE_COPY_ACCELERATION_STRUCTURE_INFO_KHR};
        info.src = compact;
        info.dst = bottom_;
        info.mode = VK_COPY_ACCELERATION_STRUCTURE_MODE_COMPACT_KHR;
        vkCmdCopyAccelerationStructureKHR(cmd, &info);
        commands.run();
    } catch (...) {
        vkDestroyAccelerationStructureKHR(device_->handle(), compact, nullptr);
        throw;
    }
    vkDestroyAccelerationStructureKHR(device_->handle(), compact, nullptr);
}

void Accel::buildTop() {
    VkAccelerationStructureInstanceKHR instance{};
    for (int i = 0; i < 3; ++i)
        instance.transform.matrix[i][i] = 1.0f;
    instance.mask = 0xff;
    instance.flags = VK_GEOMETRY_INSTANCE_TRIANGLE_FACING_CULL_DISABLE_BIT_KHR;
    instance.accelerationStructureReference = addressOf(*device_, bottom_);
    const Buffer instances =
        makeBuffer(*device_, std::span<const VkAccelerationStructureInstanceKHR>(&instance, 1),
                   "acceleration structure instance", kInputUsage);

    VkAccelerationStructureGeometryKHR geometry{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_KHR};
    geometry.geometryType = VK_GEOMETRY_TYPE_INSTANCES_KHR;
    geometry.geometry.instances = {VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_INSTANCES_DATA_KHR};
    geometry.geometry.instances.data.deviceAddress = instances.address();
    VkAccelerationStructureBuildGeometryInfoKHR info{
        VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_GEOMETRY_INFO_KHR};
    info.type = VK_ACCELERATION_STRUCTURE_TYPE_TOP_LEVEL_KHR;
    info.flags = VK_BUILD_ACCELERATION_STRUCTURE_PREFER_FAST_TRACE_BIT_KHR;
    info.mode = VK_BUILD_ACCELERATION_STRUCTURE_MODE_BUILD_KHR;
    info.geometryCount = 1;
    info.pGeometries = &geometry;
    const uint32_t count = 1;
    VkAccelerationStructureBuildSizesInfoKHR sizes{
        VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_SIZES_INFO_KHR};
    vkGetAccelerationStructureBuildSizesKHR(
        device_->handle(), VK_ACCELERATION_STRUCTURE_BUILD_TYPE_DEVICE_KHR, &info, &count, &sizes);

    topBuffer_ = Buffer(*device_, {.size = sizes.accelerationStructureSize,
                                   .extraUsage = kStorageUsage,
                                   .name = "top level acceleration structure"});
    top_ = createIn(*device_, topBuffer_, sizes.accelerationStructureSize, info.type);
    const Scratch scratch = makeScratch(*device_, sizes.buildScratchSize);
    info.dstAccelerationStructure = top_;
    info.scratchData.deviceAddress = scratch.address;
    const VkAccelerationStructureBuildRangeInfoKHR range{count, 0, 0, 0};
    const VkAccelerationStructureBuildRangeInfoKHR* rangeOfInfo = &range;
    Commands commands(*device_);
    VkCommandBuffer cmd = commands.begin();
    vkCmdBuildAccelerationStructuresKHR(cmd, 1, &info, &rangeOfInfo);
    barrier(cmd);
    commands.run();
    topAddress_ = addressOf(*device_, top_);
}

Accel::~Accel() {
    release();
}

Accel::Accel(Accel&& other) noexcept {
    *this = std::move(other);
}

Accel& Accel::operator=(Accel&& other) noexcept {
    if (this == &other) return *this;
    release();
    device_ = std::exchange(other.device_, nullptr);
    bottomBuffer_ = std::move(other.bottomBuffer_);
    topBuffer_ = std::move(other.topBuffer_);
    bottom_ = std::exchange(other.bottom_, VK_NULL_HANDLE);
    top_ = std::exchange(other.top_, VK_NULL_HANDLE);
    topAddress_ = std::exchange(other.topAddress_, 0);
    bytes_ = std::exchange(other.bytes_, 0);
    return *this;
}

void Accel::release() {
    if (device_ == nullptr) return;
    if (top_ != VK_NULL_HANDLE) vkDestroyAccelerationStructureKHR(device_->handle(), top_, nullptr);
    if (bottom_ != VK_NULL_HANDLE) vkDestroyAccelerationStructureKHR(device_->handle(), bottom_, nullptr);
}

} // namespace relume::vk
