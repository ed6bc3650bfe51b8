#pragma once

#include <algorithm>
#include <functional>
#include <vector>

#include "bake/direct/emitter_light.h"
#include "bake/direct/lamp_light.h"
#include "bake/direct/point_trace.h"
#include "bake/gather/link_kit.h"
#include "bake/layers/layer.h"

namespace relume {

/// Holds what shines in each layer, as its direct light samples it: a group of mesh lights by their light
/// tree, and groups of analytic lights that share batches of rays.
class LayerLights {
public:
    /// Each light gets few points per patch and sample pass, so that a light that moves is seen soon.
    static constexpr uint32_t kPoints = shader::kReplicates;

    explicit LayerLights(LinkKit& kit);

    /// Makes the parts of each layer's direct light. Members of groups are weighed here, all others shine
    /// with
    /// 1. No batch may be under way.
    void assign(const std::vector<std::unique_ptr<Layer>>& layers);
    /// Returns the radiance of the sky that links bring a layer, for a unit of its weight; 0: none of it is
    /// the sky's, or rays are sent to that.
    glm::vec3 skyOfLinks(const Layer& layer) const;
    /// Follows triangles that stand elsewhere now. Returns whether rays to suns and the sky end elsewhere,
    /// too.
    bool follow();
    /// Returns how far away rays to suns and the sky end [m].
    float reach() const { return lamps_.reach(); }
    /// Returns how many mesh lights there are in all layers.
    size_t emitterCount() const;
    /// Returns how many chunks a batch of the part may have, with so many sample passes in one.
    uint32_t batchChunks(const DirectPart& part, uint32_t together) const {
        return std::max(1u, (part.emitters ? emitters_.batchChunks() : lamps_.batchChunks()) / together);
    }

    /// One portion of a sample pass of a part, or of several.
    struct Portion {
        DirectPart part;
        uint32_t samplePass = 0, together = 1; // the first one, a multiple of their number
        ChunkRange range;
        const Penumbra* penumbra = nullptr;
        bool newSums = false; // nothing is in the sums yet: the CPU writes all of them
        uint32_t mark = 0;    // first of three marks of time
    };
    /// Tells whether the CPU draws, traces and gathers the part, without a submit that takes longer than a
    /// small batch.
    bool onCpu(const DirectPart& part) const;
    /// Does so, into the kit's direct sums.
    void traceOnCpu(const Portion& portion);
    /// Records the portion or, with a tracer that does not record (cmd is null), runs it. `before` records
    /// what goes ahead of it.
    void trace(VkCommandBuffer cmd, const Portion& portion,
               const std::function<void(VkCommandBuffer)>& before);

private:
    /// Mesh lights whose direct light is sampled together.
    struct EmitterGroup {
        std::vector<EmitterChoice> choices;
        EmitterSet set;
    };
    void assignEmitters(const std::vector<std::unique_ptr<Layer>>& layers);
    template<typename Lights>
    static typename Lights::Work workOf(const Portion& portion);
    template<typename Lights>
    void traceOnCpuWith(const Lights& lights, const Portion& portion);
    void note(const PointTimes& times);
    template<typename Lights>
    void traceWith(Lights& lights, VkCommandBuffer cmd, const Portion& portion,
                   const std::function<void(VkCommandBuffer)>& before);

    LinkKit& kit_;
    EmitterLight emitters_;
    LampLight lamps_;
    std::vector<EmitterGroup> emitterGroups_; // of emitters_
};

} // namespace relume
