#pragma once

#include <array>
#include <memory>
#include <vector>

#include "bake/pairs/quad_tree.h"
#include "bake/pairs/sender_list.h"
#include "bake/show/publisher.h"
#include "bake/solver/solver.h"
#include "bake/surface/light_buffers.h"

namespace relume {

/// One quantity of every patch, padding included, as Publisher::Update takes it.
using PatchValues = std::vector<glm::vec4>;

/// The quantities of the thesis' texture group.
enum class PatchQuantity {
    Position, // pos [m]
    Normal,   // nrm: shading normal, unit
    Albedo,   // mat
    Area,     // arf [m^2], in R
};

/// Makes what visualisations (VIT) show of the patches of a bake, beside their light: asked for now and then,
/// not every frame. Texels and chunks are those of the bake. It is not thread-safe: it belongs to the bake's
/// thread.
class PatchInspector {
public:
    static constexpr uint32_t kMaxMip = 4;

    /// The things that it looks at; all must outlive it.
    struct Input {
        const vk::Device& device;
        const PatchSet& patches;
        const LightBuffers& light;
        Tracer& tracer;
        TransportSettings transport;
        LinkSettings links; // directions and their rotation
    };
    explicit PatchInspector(const Input& input) : input_(input) {}

    PatchValues quantity(PatchQuantity quantity) const;
    /// Return what the passes read and what they have written so far (the thesis' ligIn and ligOut), in the
    /// solver's unit; they ask the device.
    PatchValues ligIn() const;
    PatchValues ligOut() const;
    /// Returns means over windows of 2^mip texels squared and of one chart, by area: what the senders of
    /// mipmapped undersampling stand for. mip <= kMaxMip.
    PatchValues mip(const PatchValues& values, uint32_t mip);
    /// Returns the quad-tree of adaptive subdivision over a light (of a pass: ligIn()): R how many patches a
    /// leaf holds, G 1 along its border, B a number in [0, 1) that tells it from others; 0 where nothing
    /// sends. desc.rtrad is the bake's whatever it says.
    PatchValues leaves(const PatchValues& light, const QuadTreeDesc& desc);
    /// Returns one number per patch (Solver::errors()) in R, G and B.
    static PatchValues grey(const std::vector<float>& values);

    /// Returns what a patch sees: R 1 for each patch that it sees, G that one's form factor over the largest
    /// of all, B 1 for the patch itself. Waits for one ray per patch that it faces.
    PatchValues seenFrom(uint32_t patch);
    struct Link {
        uint32_t target; // a patch, or shader::kLinkSky, kLinkBack, kLinkDark
        glm::vec3 end;   // [m]: where that patch is; without one a point in the direction that was asked
    };
    /// Returns where the first directions of a patch of directional sampling end. count must be a multiple of
    /// 8, at least 8.
    std::vector<Link> links(uint32_t patch, uint32_t count);

    /// Returns the patch that texel (x, y) shows; beside charts the nearest one within the filled rings, else
    /// shader::kNoPatch.
    uint32_t patchAt(uint32_t x, uint32_t y) const;

    /// The set voxels of a voxel map.
    struct Voxels {
        glm::vec3 edge{0.0f}; // [m], of each
        std::vector<glm::vec3> centres;
    };
    /// Returns the voxels of the map that the voxel tracer marches through at this resolution, made for the
    /// purpose. Throws Error where the device cannot make one.
    Voxels voxels(uint32_t resolution) const;

private:
    std::vector<uint32_t> seeingBits(uint32_t patch);
    std::vector<uint32_t> seeingBitsRtrad(uint32_t patch);
    float formFactor(uint32_t from, uint32_t to) const;
    const std::vector<uint32_t>& parts();

    Input input_;
    std::vector<uint32_t> parts_; // mergeableParts, once it is needed
    struct Windows {
        std::vector<shader::Sender> runs;
        std::vector<uint32_t> members;
    };
    std::array<Windows, kMaxMip + 1> windows_; // windows of each mip, once it is needed
};

} // namespace relume
