#pragma once

#include "bake/pairs/sender_light.h"
#include "bake/pairs/sender_list.h"
#include "bake/solver/solver.h"

namespace relume {

/// Decides who sends in the passes of a pair method, and how much.
class PairSenders {
public:
    PairSenders(const SolverInput& input, const SolverSettings& settings);

    SenderKind kind() const { return kind_; }
    /// Returns the chunks of senders; maxColumns() returns how many there are at most.
    uint32_t columns() const;
    uint32_t maxColumns() const;
    /// Prepares a pass that starts from this light; lists that follow the light are made anew. threshold is
    /// that of the quad-tree. It reads the device's chunkSends where patches themselves send or are drawn.
    void prepare(const std::vector<glm::vec4>& light, double threshold);
    /// Tells for each column whether anything in it sends.
    const std::vector<uint32_t>& sends() const { return sends_; }
    const vk::Buffer& sendsBuffer() const;
    /// Tells for each column whether its senders differ from those of the pass before.
    const std::vector<bool>& changed() const { return changed_; }
    const SenderBuffers* buffers() const { return kind_ == SenderKind::Patches ? nullptr : &buffers_; }
    const SenderRuns* runs() const { return kind_ == SenderKind::Patches ? nullptr : &runs_; }
    /// Returns, for RTRad, the window of senders that a receiver skips beside itself [texels].
    uint32_t skippedWindow() const { return adaptive_ ? 1 : pairs_.window; }

    /// Returns the device bytes of a list of so many senders, padding included, that have so many members.
    static uint64_t bytes(uint64_t senders, uint64_t members, SenderKind kind);

private:
    void setList(SenderList list);
    void listSending(const std::vector<uint32_t>& chunkSends);
    void uploadSends();
    void sendRadiance(const std::vector<glm::vec4>& radiance);

    const vk::Device& device_;
    const PatchSet& patches_;
    const LightBuffers& light_;
    TransportSettings transport_;
    PairSettings pairs_;
    SenderKind kind_ = SenderKind::Patches;
    SenderLight lightKind_ = SenderLight::First;
    bool adaptive_ = false;
    std::vector<uint32_t> parts_; // mergeableParts, of adaptive
    SenderList list_;
    std::vector<shader::Sender> traced_; // of list_, one patch each unless drawn
    SenderBuffers buffers_;
    SenderRuns runs_;
    std::vector<uint32_t> sends_;
    std::vector<bool> changed_;
};

} // namespace relume
