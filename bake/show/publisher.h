#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "bake/surface/patches.h"
#include "bake/vk/commands.h"
#include "bake/vk/program.h"
#include "bake/vk/shared_image.h"

namespace relume {

/// Part of a lightmap.
struct TexelArea {
    uint32_t x = 0, y = 0, width = 0, height = 0; // [texels]
};

/// Returns a power of two, Update::unit for values up to this one: below half of what a half holds, with all
/// bits of values 2^28 times smaller. It is 1 for 0.
float unitFor(float largest);

/// Turns what patches hold (lighting, or anything else with three channels) into texels for display, seams
/// filled as makeLightmap (bake/output/lightmap.h) does, and keeps up to kSlots copies of them current.
/// Texels are four halves: value / unit, coverage (1 a patch, 0.5 filled, 0 empty); row 0 is v = 0. Only what
/// changed is computed and copied. Every call waits for the device, in submits of a few milliseconds.
class Publisher {
public:
    static constexpr uint32_t kSlots = 3;
    static constexpr size_t kTexelBytes = 8;

    struct Desc {
        uint32_t rings = 4;        // of texels filled around charts
        float reflectivity = 1.0f; // of the bake, for unit()
    };
    /// Takes patches of which those inside something are marked (InsideSearch). In the RTRad preset one ring
    /// is filled with the darkest neighbour. Throws Error.
    Publisher(const vk::Device& device, const PatchSet& patches, const Desc& desc);

    uint32_t size() const { return size_; } // [texels]
    /// Returns the unit for lighting, however often it bounces between these patches [cd/m^2].
    float unit() const { return unit_; }
    /// Updates the unit for the same patches, which emit or reflect otherwise now.
    void updateUnit(const PatchSet& patches);
    /// Returns every chunk, for Update::chunks.
    std::span<const uint32_t> allChunks() const { return allChunks_; }

    struct Update {
        const vk::Buffer& values;         // vec4 per patch, padding included; a unused
        std::span<const uint32_t> chunks; // whose values may differ from the update before; the first one
                                          // takes all
        float unit = 1.0f;                // what a texel's 1 stands for
    };
    /// Brings the texels up to date. Nothing may write the values meanwhile.
    void update(const Update& update);
    /// Returns the mean of the values of all patches that are shown, as of the last update.
    glm::vec3 mean() const { return mean_; }

    /// Brings what was written for `slot` before up to date and returns what had to be copied: at least a
    /// region of shader::kRegion texels squared for each one that changed, nothing where nothing did. The
    /// first time all of it is copied. The image must not be read meanwhile.
    std::vector<TexelArea> publish(const vk::SharedImage& image, uint32_t slot);
    /// Does the same into size * size * kTexelBytes bytes of memory.
    std::vector<TexelArea> publish(std::span<std::byte> texels, uint32_t slot);

    /// Lets all slots count as never written: they hold something else now.
    void forget();

private:
    void recordUpdate(VkCommandBuffer cmd, shader::PublishPush push, std::span<const uint32_t> chunks);
    void readReport();
    std::vector<TexelArea> changedAreas(uint32_t slot) const;
    const std::byte* hostTexels(const std::vector<TexelArea>& areas);
    uint32_t regionsPerRow() const { return (size_ + shader::kRegion - 1) / shader::kRegion; }

    const vk::Device& device_;
    uint32_t size_, chunkCount_;
    uint32_t chunksAtOnce_; // in one submit
    uint32_t rings_;
    float reflectivity_ = 1.0f, unit_ = 1.0f;
    vk::ComputeProgram scatter_, sum_;
    vk::Commands commands_;
    vk::Buffer texels_;         // uvec2 per texel: what is shown
    vk::Buffer patchTexels_;    // uint per patch
    vk::Buffer fills_, starts_; // SeamPlan
    vk::Buffer chunks_;  // uint: chunksAtOnce_ of the update, behind them those with fills; on the host
    vk::Buffer sums_;    // vec4 per chunk: of what it shows; on the host
    vk::Buffer changed_; // uint per region
    vk::Buffer report_;  // the same on the host
    vk::Buffer staging_; // the texels on the host, where it does not see those of the device
    std::vector<uint32_t> allChunks_;
    std::vector<uint8_t> hasFills_;                     // per chunk
    std::array<std::vector<uint8_t>, kSlots> outdated_; // per region: a slot's copy is an old one
    glm::vec3 mean_{0.0f};
    bool updated_ = false;
};

} // namespace relume
