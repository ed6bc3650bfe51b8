#pragma once

#include <vector>

#include "bake/surface/trace_scene.h"
#include "bake/vk/buffer.h"

namespace relume {

/// The settings of rays that march through voxels.
struct VoxelSettings {
    uint32_t resolution = 128; // voxels along each edge of the map, kMinVoxels..kMaxVoxels
    uint32_t ratio = 0;        // one sender in `ratio` marches, by its texel as RTRad has it; 0 or 1: all
};
constexpr uint32_t kMinVoxels = 32, kMaxVoxels = 512;

/// The result of the CVM pass (calculate voxel map) on a scene: one bit per voxel, set where a triangle
/// touches it, and for each set voxel up to six patches, one for each side that surfaces in it face. Voxels
/// are cubes over the scene's bounds and half a voxel more; with scene.rtrad they divide the bounds as RTRad
/// has them, one voxel is set per pixel that a triangle touches, and there are no patches. Those parts of
/// alpha-masked triangles count that are solid somewhere in a column of voxels.
class VoxelMap {
public:
    /// Makes the map; `patches` is scene.patches on the device, for those who ask for links. Throws Error
    /// when the map does not fit the device's memory.
    VoxelMap(const vk::Device& device, const TraceScene& scene, const VoxelSettings& settings,
             VkDeviceAddress patches = 0);

    VkDeviceAddress address() const { return header_.address(); } // of a shader::VoxelGrid
    const shader::VoxelGrid& grid() const { return grid_; }
    uint64_t setVoxels() const { return setVoxels_; }
    /// Returns the bits, 32 voxels to a word, x fastest; asks the device.
    std::vector<uint32_t> readBits(const vk::Device& device) const;

    /// Returns the device bytes of a map that has links, with so many set voxels.
    static uint64_t bytes(uint32_t resolution, uint64_t setVoxels);
    /// Returns them for two layers of set voxels over each of the box's faces.
    static uint64_t bytes(uint32_t resolution);

private:
    class Pass;
    void rank(const vk::Device& device);

    shader::VoxelGrid grid_{};
    vk::Buffer header_, bits_, ranks_, patches_;
    uint64_t setVoxels_ = 0;
};

} // namespace relume
