#pragma once

#include <memory>
#include <vector>

#include "bake/surface/light_buffers.h"
#include "bake/surface/patch_material.h"
#include "bake/vk/commands.h"
#include "bake/vk/program.h"

namespace relume {

/// Follows changes of materials' colours and strengths, in the patches and in the device's copy of them. The
/// device makes its albedo itself, from 20 bytes per patch: a large material's would take longer to send.
class SurfaceColours {
public:
    /// Takes the materials that the patches were made with.
    explicit SurfaceColours(std::vector<Material> materials);
    void update(const vk::Device& device, const std::vector<Material>& materials, PatchSet& patches,
                LightBuffers& light);
    /// Updates all patches, also where their patterns have changed.
    void updateAll(const vk::Device& device, const std::vector<Material>& materials, PatchSet& patches,
                   LightBuffers& light);

    /// Returns the device bytes for patches in so many chunks, from the first update of base colours on.
    static uint64_t bytes(uint32_t chunks) {
        return uint64_t{chunks} * shader::kChunk * (sizeof(uint32_t) + sizeof(glm::vec4));
    }

private:
    struct Changed {
        bool albedo = false, emission = false;
    };
    std::vector<Changed> changesTo(const std::vector<Material>& materials) const;
    bool updateBlock(const std::vector<Material>& materials, const std::vector<Changed>& changed,
                     PatchSet& patches, size_t block, int64_t& clamped) const;

    /// The device's data to follow base colours, made in the first update.
    struct OnDevice {
        vk::Buffer materials, pattern, baseColors; // as RecolourPush has them
        vk::ComputeProgram recolour;
        vk::Commands commands;

        OnDevice(const vk::Device& device, const PatchSet& patches, size_t materialCount);
    };
    void recolour(const vk::Device& device, const std::vector<Material>& materials,
                  const std::vector<Changed>& changed, const PatchSet& patches, const LightBuffers& light);

    std::vector<Material> applied_; // with glTF's default material as the last one
    std::unique_ptr<OnDevice> onDevice_;
};

} // namespace relume
