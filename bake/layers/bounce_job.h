#pragma once

#include <vector>

#include "bake/base/light_error.h"
#include "bake/gather/link_batches.h"
#include "bake/gather/chunk_senders.h"
#include "bake/layers/layer_gather.h"

namespace relume {

/// Bounces the light of one layer, or of several side by side, over links until each has converged: first
/// over those of the first sample pass, then over all of them. With a number of passes given, all links are
/// gathered so many times.
class BounceJob {
public:
    /// Holds what the jobs share, one after the other.
    struct Tools {
        LinkKit& kit;
        LayerGather& gather;
        LinkBatches& batches;
        const ChunkSenders& senders;
        bool distancesKnown = false; // of the links of the first sample pass, which all layers share
    };
    /// One of the layers that bounce together. It must stay where it is while it is live.
    struct Lane {
        Layer* layer = nullptr;
        LayerLevel target;
        glm::vec3 sky{0.0f};   // radiance that links to the sky bring it (LayerLights::skyOfLinks)
        bool live = true;      // goes on in this stage
        uint32_t look = 0;     // after so many bounces the CPU looks whether they have converged
        uint32_t looked = 0;   // after so many it last did
        uint64_t gathered = 0; // links, in all its bounces
        BounceSeries series;
    };
    struct Desc {
        std::vector<Lane> lanes;           // of layers that want as many links
        bool sum = false;                  // the lane is not a layer, but all of them together
        bool hasty = false;                // a first level that others follow
        const vk::Buffer* first = nullptr; // the light that bounces first; nullptr: the layers' direct light
    };
    BounceJob(Tools& tools, Desc desc);

    /// Makes a batch. Returns the lanes whose level is gathered, to be resolved before the next batch.
    std::vector<uint32_t> batch();
    bool over() const { return over_; }
    const std::vector<Lane>& lanes() const { return desc_.lanes; }
    bool sum() const { return desc_.sum; }
    /// Tells whether the lane's bounces were in haste and left dark places without much of their light.
    bool endedInHaste(const Lane& lane) const;
    /// Tells whether the layer is still under way.
    bool needs(const Layer* layer) const;
    /// Tells whether the layer that leads the job has a level, or has just got one.
    bool leaderHasLevel() const;
    uint32_t gathers() const { return gathers_; } // over the links of all sample passes, so far

private:
    enum class Stage : uint8_t { Bounces, Gather };
    using Portion = LinkBatches::Portion;
    void beginPass(Stage stage);
    bool onePortion(const Portion& portion);
    bool knownPortions(Portion portion);
    std::vector<VkDeviceAddress> following(const Portion& portion, double most) const;
    const vk::Buffer& firstLight(const Lane& lane) const;
    void startAtOnce();
    void recordPassBegin(VkCommandBuffer cmd);
    void recordGather(VkCommandBuffer cmd, const Portion& portion,
                      const std::vector<VkDeviceAddress>& following);
    void noteLinks(const Portion& portion, size_t following);
    bool recordsPassEnd() const;
    bool recordPassEnd(VkCommandBuffer cmd);
    bool recordGatherEnd(VkCommandBuffer cmd);
    void recordPassLight(VkCommandBuffer cmd);
    bool isLastGather() const;
    bool tellsChange() const;
    uint32_t nextLook() const;
    std::vector<uint32_t> look();
    std::vector<uint32_t> lookAtGather();
    void learnChanges(uint32_t lane, bool both);
    double iterationAim() const;
    double localIterationAim() const;
    bool hasConverged(const Lane& lane) const;
    bool wantsDistances() const;
    uint32_t linkSamplePasses() const { return desc_.lanes.front().target.linkSamplePasses; }

    Tools* tools_;
    Desc desc_;
    Stage stage_;
    uint32_t samplePass_ = 0; // sample pass of links that are gathered
    uint32_t bounce_ = 0;     // finished ones, over the links of the first sample pass
    uint32_t gathers_ = 0;    // finished ones, over the links of all sample passes
    bool begun_ = false;      // a batch of this pass has been made
    bool lit_ = false;        // what patches send is that of the light so far
    bool over_ = false;
};

} // namespace relume
