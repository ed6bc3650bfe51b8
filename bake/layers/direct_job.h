#pragma once

#include <optional>
#include <vector>

#include "bake/layers/layer_lights.h"
#include "bake/layers/layer_passes.h"
#include "bake/layers/layer_store.h"
#include "bake/layers/penumbra_map.h"

namespace relume {

/// Makes the direct light of one layer, batch by batch: the sample passes of its next level or, where objects
/// have moved, those that it had, anew in dirty chunks.
class DirectJob {
public:
    /// Holds what the jobs of all layers share, one after the other.
    struct Tools {
        LinkKit& kit;
        const LayerPass& layerPass;
        LayerLights& lights;
        PenumbraMap& penumbra;
        LayerStore& store;
        BatchRate rate;
    };
    /// Tells what has come of a batch.
    enum class End : uint8_t {
        NotYet,  // there is more to do
        Made,    // the layer has the direct light of its level
        Paused,  // the first step of dirty chunks is there, and all lights are to be seen in one
        Repaired // no chunk is dirty any more
    };
    /// The layer must stay where it is. With `alone` bounces wait for other layers to come along.
    DirectJob(Tools& tools, Layer& layer, LayerLevel target, bool alone)
        : tools_(&tools), layer_(&layer), target_(target), alone_(alone) {}

    /// Begins; `pauses` says that a repair is to pause after its first step, here and below.
    End begin(bool pauses);
    End batch(bool pauses);

    Layer& layer() const { return *layer_; }
    LayerLevel target() const { return target_; }
    bool alone() const { return alone_; }

private:
    End beginRepair(bool pauses);
    void beginPass();
    uint32_t together() const;
    void trace(VkCommandBuffer cmd, ChunkRange range, uint32_t mark);
    bool nextPart();
    uint32_t endOfStep() const;
    bool orderSamplePass();
    bool seekSamplePass();
    std::vector<uint8_t> repairedMarks() const;
    End endFirstSamplePass(VkCommandBuffer cmd, bool pauses);
    End endStep(VkCommandBuffer cmd);
    End endRepairStep(bool pauses);
    void learnPenumbra();
    void learnRepairedPenumbra();
    void setPenumbra();
    std::shared_ptr<vk::Buffer> recordOwnDirect(VkCommandBuffer cmd);

    Tools* tools_;
    Layer* layer_;
    LayerLevel target_;
    bool alone_;
    uint32_t samplePass_ = 0;            // the first one of those that are taken together
    uint32_t part_ = 0;                  // of Layer::parts, within these
    std::vector<uint8_t> penumbra_;      // chunks with a part of Layer::penumbra; empty: not known yet
    bool begun_ = false;                 // a batch of this step has been made
    std::optional<uint32_t> repairStep_; // step of Layer::directSteps; set while dirty chunks are repaired
};

} // namespace relume
