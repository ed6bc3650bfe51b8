#include "bake/trace/voxel_map.h"

#include "assets/base/clock.h"
#include "assets/base/error.h"
#include "bake/vk/commands.h"
#include "bake/vk/program.h"

#include <algorithm>
#include <bit>

namespace relume {
namespace {

constexpr uint32_t kVerticesPerTriangle = 6; // cvm.vert draws a rectangle
// The aim of one submit. A first one of few triangles is short on every device, then a batch may grow
// fourfold.
constexpr double kBatchMs = 20.0;
constexpr uint32_t kFirstBatch = 64; // triangles

uint64_t wordCount(uint32_t resolution) {
    return (uint64_t{resolution} * resolution * resolution + 31) / 32;
}

shader::VoxelGrid makeGrid(const TraceScene& scene, const VoxelSettings& settings) {
    glm::vec3 lo = scene.mesh.positions[0], hi = lo;
    for (const glm::vec3& p : scene.mesh.positions) {
        lo = glm::min(lo, p);
        hi = glm::max(hi, p);
    }
    const glm::vec3 extent = hi - lo;
    const auto resolution = static_cast<float>(settings.resolution);
    shader::VoxelGrid grid{};
    grid.resolution = settings.resolution;
    grid.ratio = std::max(settings.ratio, 1u);
    grid.origin = lo;
    if (scene.rtrad) {
        for (int axis = 0; axis < 3; ++axis)
            grid.scale[axis] = extent[axis] > 0 ? (resolution - 0.51f) / extent[axis] : 0.0f;
    } else {
        // Half a voxel of margin is added: walls on the bounds then lie in the middle of one layer of voxels.
        const float voxel = std::max(extent.x, std::max(extent.y, extent.z)) / (resolution - 1.0f);
        grid.origin -= 0.5f * voxel;
        grid.scale = glm::vec3(1.0f / voxel);
    }
    return grid;
}

std::vector<uint8_t> wholeWords(std::vector<uint8_t> bytes) {
    bytes.resize((bytes.size() + 3) / 4 * 4);
    return bytes;
}

void fill(const vk::Device& device, const vk::Buffer& buffer, uint32_t value) {
    vk::Commands commands(device);
    VkCommandBuffer cmd = commands.begin();
    vkCmdFillBuffer(cmd, buffer.handle(), 0, VK_WHOLE_SIZE, value);
    vk::barrier(cmd);
    commands.run();
}

} // namespace

// Draws the scene into the map; holds what only the drawing needs.
class VoxelMap::Pass {
public:
    Pass(const vk::Device& device, const TraceScene& scene, VkDeviceAddress header)
        : program_(device, {.vertex = "cvm_vert", .fragment = "cvm_frag", .formats = {}, .constants = {}},
                   {}),
          commands_(device), positions_(vk::makeBuffer(device, scene.mesh.positions, "positions")),
          hitTriangles_(vk::makeBuffer(device, scene.hitTriangles, "hit triangles")),
          texelToPatch_(vk::makeBuffer(device, scene.texelToPatch, "texel to patch")),
          patchChart_(vk::makeBuffer(device, scene.sendingCharts(), "chart of patch")),
          alphaTriangles_(vk::makeBuffer(device, scene.alphaTriangles, "alpha triangles")),
          alphaMaterials_(vk::makeBuffer(device, scene.alphaMaterials, "alpha materials")),
          alphaTexels_(vk::makeBuffer(device, wholeWords(scene.alphaTexels), "alpha texels")) {
        push_.geometry = {.accel = header,
                          .triangles = positions_.address(),
                          .alphaTriangles = alphaTriangles_.address(),
                          .alphaMaterials = alphaMaterials_.address(),
                          .alphaTexels = alphaTexels_.address(),
                          .opaqueCount = scene.mesh.opaqueCount,
                          .triangleCount = scene.mesh.triangleCount()};
        push_.hitTriangles = hitTriangles_.address();
        push_.texelToPatch = texelToPatch_.address();
        push_.patchChart = patchChart_.address();
        push_.size = scene.size;
        push_.rtrad = scene.rtrad ? 1u : 0u;
    }

    /// Sets bits, or stores the patches of set voxels.
    void draw(uint32_t resolution, bool patches) {
        push_.patches = patches ? 1u : 0u;
        uint32_t batch = kFirstBatch;
        for (uint32_t first = 0; first < push_.geometry.triangleCount;) {
            const uint32_t count = std::min(batch, push_.geometry.triangleCount - first);
            push_.firstTriangle = first;
            const auto start = Clock::now();
            VkCommandBuffer cmd = commands_.begin();
            program_.draw(cmd, push_, VkExtent2D{resolution, resolution}, count * kVerticesPerTriangle);
            vk::barrier(cmd);
            vk::hostBarrier(cmd);
            commands_.run();
            const double ms = 1000.0 * secondsSince(start);
            const double wanted = count * kBatchMs / std::max(ms, 1e-3);
            batch = static_cast<uint32_t>(std::clamp(wanted, 1.0, 4.0 * count));
            first += count;
        }
    }

private:
    vk::RasterProgram program_;
    vk::Commands commands_;
    vk::Buffer positions_, hitTriangles_, texelToPatch_, patchChart_;
    vk::Buffer alphaTriangles_, alphaMaterials_, alphaTexels_;
    shader::CvmPush push_{};
};

uint64_t VoxelMap::bytes(uint32_t resolution, uint64_t setVoxels) {
    return sizeof(shader::VoxelGrid) +
           (2 * wordCount(resolution) + setVoxels * shader::kVoxelSides) * sizeof(uint32_t);
}

uint64_t VoxelMap::bytes(uint32_t resolution) {
    constexpr uint64_t kLayers = 2, kFaces = 6;
    return bytes(resolution, kLayers * kFaces * resolution * resolution);
}

VoxelMap::VoxelMap(const vk::Device& device, const TraceScene& scene, const VoxelSettings& settings,
                   VkDeviceAddress patches)
    : grid_(makeGrid(scene, settings)) {
    ASSERT(settings.resolution >= kMinVoxels && settings.resolution <= kMaxVoxels);
    header_ = vk::Buffer(device, {.size = sizeof(grid_), .name = "voxel grid"});
    bits_ =
        vk::Buffer(device, {.size = wordCount(settings.resolution) * sizeof(uint32_t), .name = "voxel bits"});
    grid_.bits = bits_.address();
    vk::upload(device, header_, &grid_, sizeof(grid_));
    fill(device, bits_, 0);
    Pass pass(device, scene, header_.address());
    pass.draw(settings.resolution, false);
    rank(device);
    if (scene.rtrad) return; // it asks for no links
    patches_ = vk::Buffer(device,
                          {.size = std::max<uint64_t>(setVoxels_, 1) * shader::kVoxelSides * sizeof(uint32_t),
                           .name = "voxel patches"});
    fill(device, patches_, shader::kNoPatch);
    grid_.ranks = ranks_.address();
    grid_.patches = patches_.address();
    grid_.scene = patches;
    vk::upload(device, header_, &grid_, sizeof(grid_));
    pass.draw(settings.resolution, true);
}

// Counts how many bits are set before each word: there a set voxel's patches lie.
void VoxelMap::rank(const vk::Device& device) {
    std::vector<uint32_t> ranks = readBits(device);
    uint32_t before = 0;
    for (uint32_t& word : ranks) {
        const auto set = static_cast<uint32_t>(std::popcount(word));
        word = before;
        before += set;
    }
    setVoxels_ = before;
    ranks_ = vk::makeBuffer(device, ranks, "voxel ranks");
}

std::vector<uint32_t> VoxelMap::readBits(const vk::Device& device) const {
    return vk::readBuffer<uint32_t>(device, bits_, wordCount(grid_.resolution));
}

} // namespace relume
